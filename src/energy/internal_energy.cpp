#include "energy/internal_energy.h"

#include <algorithm>
#include <cmath>

#include "energy/edge.h"
#include "energy/shear.h"
#include "energy/triple.h"
#include "energy/twist.h"

namespace haptic_cloth {
namespace {

/// A law within a step; `steps` is empty where no law of the kind has memory.
struct StepLaw {
  StepLaw(const Loop& l, const std::vector<Loop::Step>& steps, int element)
      : law(l), step(steps.empty() ? kNoMemory : steps[element]) {}

  Curve::Point operator()(double s) const { return law(step, s); }

  static constexpr Loop::Step kNoMemory{};
  const Loop& law;
  const Loop::Step& step;
};

}  // namespace

InternalEnergy::InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh)
    : mesh_(mesh),
      stretch_(fabric.tensile),
      bend_(fabric.bending),
      shear_(fabric.shear),
      twist_rigidity_(fabric.twist_rigidity),
      bends_(!bend_[kWarp].isZero() || !bend_[kWeft].isZero()),
      shears_(!shear_.isZero() || twist_rigidity_ > 0.0) {
  node_normals_.reserve(mesh.grid.particles());
  slots_.reserve(mesh.edges.capacity() + mesh.triples.capacity() +
                 mesh.slots_per_patch * mesh.patches.capacity());
  if (twist_rigidity_ > 0.0) patch_normals_.reserve(mesh.patches.capacity());
  edge_tangents_.reserve(mesh.edges.capacity());
  triple_stiffness_.reserve(mesh.triples.capacity());
  patch_tangents_.reserve(mesh.patches.capacity());
  if (hasMemory(stretch_)) edge_steps_.reserve(mesh.edges.capacity());
  if (hasMemory(bend_)) triple_steps_.reserve(mesh.triples.capacity());
  if (shear_.hasMemory()) patch_steps_.reserve(mesh.patches.capacity());
  resize();
  for (int e = 0; e < static_cast<int>(edge_steps_.size()); ++e) {
    const Loop& law = stretch_[mesh_.edges[e].direction];
    edge_steps_[e] = law.begin(law.initialPlay());
  }
  for (int t = 0; t < static_cast<int>(triple_steps_.size()); ++t) {
    const Loop& law = bend_[mesh_.triples[t].direction];
    triple_steps_[t] = law.begin(law.initialPlay());
  }
  std::fill(patch_steps_.begin(), patch_steps_.end(), shear_.begin(shear_.initialPlay()));
}

void InternalEnergy::resize() {
  edge_count_ = static_cast<int>(mesh_.edges.size());
  triple_count_ = bends_ ? static_cast<int>(mesh_.triples.size()) : 0;
  patch_count_ = shears_ ? static_cast<int>(mesh_.patches.size()) : 0;
  slots_.assign(mesh_.slots(), Vec3::Zero());
  if (hasMemory(stretch_)) edge_steps_.resize(edge_count_);
  if (hasMemory(bend_)) triple_steps_.resize(triple_count_);
  if (shear_.hasMemory()) patch_steps_.resize(patch_count_);
  edge_tangents_.resize(edge_count_);
  triple_stiffness_.resize(triple_count_);
  patch_tangents_.resize(patch_count_);
}

void InternalEnergy::setNormals(const std::vector<Vec3>& positions) {
  node_normals_.assign(mesh_.nodes(), Vec3::Zero());
  patch_normals_.clear();
  for (const Patch& patch : mesh_.patches) {
    const auto& n = patch.nodes;
    const Vec3 normal =
        (positions[n[3]] - positions[n[0]]).cross(positions[n[2]] - positions[n[1]]);  // weighted by area
    for (const int corner : n) node_normals_[corner] += normal;
    if (twist_rigidity_ > 0.0) patch_normals_.push_back(normal.stableNormalized());
  }
  for (Vec3& normal : node_normals_) {
    const double length = normal.norm();
    if (length > 0.0) normal /= length;
  }
}

InternalEnergy::Energy InternalEnergy::evaluate(int begin, int end, const std::vector<Vec3>& x) {
  const int triples = edge_count_, patches = triples + triple_count_;
  const auto part = [&](int from, int to) {
    return std::pair(std::clamp(begin, from, to) - from, std::clamp(end, from, to) - from);
  };
  const auto [e0, e1] = part(0, triples);
  const auto [t0, t1] = part(triples, patches);
  const auto [p0, p1] = part(patches, size());
  return {evaluateEdges(e0, e1, x), evaluateTriples(t0, t1, x) + evaluateTwists(p0, p1, x),
          evaluatePatches(p0, p1, x)};
}

double InternalEnergy::evaluateEdges(int begin, int end, const std::vector<Vec3>& x) {
  double energy = 0.0;
  for (int e = begin; e < end; ++e) {
    const Edge& edge = mesh_.edges[e];
    const EdgeResult r = evaluateEdge(x[edge.a], x[edge.b], edge.length, edge.width,
                                      StepLaw(stretch_[edge.direction], edge_steps_, e));
    energy += r.energy;
    slots_[e] = r.gradient;
    edge_tangents_[e] = {r.axis, r.along, r.across};
  }
  return energy;
}

double InternalEnergy::evaluateTriples(int begin, int end, const std::vector<Vec3>& x) {
  double energy = 0.0;
  Vec3* slots = slots_.data() + mesh_.edges.size();
  for (int t = begin; t < end; ++t) {
    const Triple& triple = mesh_.triples[t];
    const Vec3& normal = node_normals_[triple.c];
    const TripleResult r =
        evaluateTriple(x[triple.l], x[triple.c], x[triple.r], normal, triple.left, triple.right, triple.area,
                       StepLaw(bend_[triple.direction], triple_steps_, t));
    energy += r.energy;
    slots[t] = r.moment * normal;
    triple_stiffness_[t] = r.stiffness;
  }
  return energy;
}

double InternalEnergy::evaluatePatches(int begin, int end, const std::vector<Vec3>& x) {
  double energy = 0.0;
  const int per_patch = mesh_.slots_per_patch;
  Vec3* slots = slots_.data() + mesh_.edges.size() + mesh_.triples.size();
  for (int k = begin; k < end; ++k) {
    const ShearResult r =
        evaluateShear(corners(k, x), mesh_.patches[k].area, StepLaw(shear_, patch_steps_, k));
    energy += r.energy;
    slots[per_patch * k] = r.force * r.rising;
    slots[per_patch * k + 1] = r.force * r.falling;
    patch_tangents_[k] = {r.rising, r.falling, r.stiffness};
  }
  return energy;
}

/// Twist counts as bending.
double InternalEnergy::evaluateTwists(int begin, int end, const std::vector<Vec3>& x) {
  if (patch_normals_.empty()) return 0.0;
  double energy = 0.0;
  Vec3* slots = slots_.data() + mesh_.edges.size() + mesh_.triples.size();
  for (int k = begin; k < end; ++k) {
    const TwistResult r =
        evaluateTwist(corners(k, x), patch_normals_[k], twist_rigidity_, mesh_.patches[k].area);
    energy += r.energy;
    slots[3 * k + 2] = r.gradient * patch_normals_[k];
  }
  return energy;
}

double InternalEnergy::curvature(int begin, int end, const std::vector<Vec3>& d) const {
  double sum = 0.0;
  for (int e = begin; e < std::min(end, edge_count_); ++e) {
    const EdgeTangent& tangent = edge_tangents_[e];
    sum +=
        edgeCurvature(tangent.axis, tangent.along, tangent.across, d[mesh_.edges[e].b] - d[mesh_.edges[e].a]);
  }
  const int patches = edge_count_ + triple_count_;
  for (int k = std::max(begin, edge_count_); k < std::min(end, patches); ++k) {
    const Triple& triple = mesh_.triples[k - edge_count_];
    const Vec3& centre = d[triple.c];
    const double change = node_normals_[triple.c].dot(triple.left * (d[triple.l] - centre) +
                                                      triple.right * (d[triple.r] - centre));
    sum += triple_stiffness_[k - edge_count_] * change * change;
  }
  for (int k = std::max(begin, patches); k < end; ++k) {
    const PatchTangent& tangent = patch_tangents_[k - patches];
    const auto& n = mesh_.patches[k - patches].nodes;
    const double change = tangent.rising.dot(d[n[3]] - d[n[0]]) + tangent.falling.dot(d[n[1]] - d[n[2]]);
    sum += tangent.stiffness * change * change;
    if (patch_normals_.empty()) continue;
    const double height = patch_normals_[k - patches].dot(saddle(corners(k - patches, d)));
    sum += twistStiffness(twist_rigidity_, mesh_.patches[k - patches].area) * height * height;
  }
  return sum;
}

void InternalEnergy::addDiagonal(std::vector<Vec3>& diagonal) const {
  for (int e = 0; e < edge_count_; ++e) {
    const EdgeTangent& t = edge_tangents_[e];
    const Vec3 value = t.along * t.axis.cwiseAbs2() + t.across * (Vec3::Ones() - t.axis.cwiseAbs2());
    diagonal[mesh_.edges[e].a] += value;
    diagonal[mesh_.edges[e].b] += value;
  }
  for (int k = 0; k < triple_count_; ++k) {
    const Triple& t = mesh_.triples[k];
    const Vec3 value = triple_stiffness_[k] * node_normals_[t.c].cwiseAbs2();
    diagonal[t.l] += t.left * t.left * value;
    diagonal[t.r] += t.right * t.right * value;
    diagonal[t.c] += (t.left + t.right) * (t.left + t.right) * value;
  }
  for (int k = 0; k < patch_count_; ++k) {
    const PatchTangent& t = patch_tangents_[k];
    const auto& n = mesh_.patches[k].nodes;
    for (const int node : {n[0], n[3]}) diagonal[node] += t.stiffness * t.rising.cwiseAbs2();
    for (const int node : {n[1], n[2]}) diagonal[node] += t.stiffness * t.falling.cwiseAbs2();
    if (patch_normals_.empty()) continue;
    const double twist = twistStiffness(twist_rigidity_, mesh_.patches[k].area);
    for (const int node : n) diagonal[node] += twist * patch_normals_[k].cwiseAbs2();
  }
}

double InternalEnergy::strain(int edge, const std::vector<Vec3>& x) const {
  const Edge& e = mesh_.edges[edge];
  return (x[e.b] - x[e.a]).norm() / e.length - 1.0;
}

double InternalEnergy::deformation(int element, const std::vector<Vec3>& x) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return strain(k, x);
  return kind == Kind::Triple ? curvature(k, x) : shearAngle(k, x);
}

Curve::Point InternalEnergy::law(int element, double deformation) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return StepLaw(stretch_[mesh_.edges[k].direction], edge_steps_, k)(deformation);
  if (kind == Kind::Patch) return StepLaw(shear_, patch_steps_, k)(deformation);
  return StepLaw(bend_[mesh_.triples[k].direction], triple_steps_, k)(deformation);
}

double InternalEnergy::area(int element) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return mesh_.edges[k].length * mesh_.edges[k].width;
  return kind == Kind::Triple ? mesh_.triples[k].area : mesh_.patches[k].area;
}

double InternalEnergy::maxStrain(const std::vector<Vec3>& x) const {
  double largest = 0.0;
  for (int e = 0; e < edge_count_; ++e) largest = std::max(largest, std::abs(strain(e, x)));
  return largest;
}

double InternalEnergy::tension(int edge, const std::vector<Vec3>& x) const {
  return StepLaw(stretch_[mesh_.edges[edge].direction], edge_steps_, edge)(strain(edge, x)).force;
}

double InternalEnergy::curvature(int triple, const std::vector<Vec3>& x) const {
  const Triple& t = mesh_.triples[triple];
  return node_normals_[t.c].dot(t.left * (x[t.l] - x[t.c]) + t.right * (x[t.r] - x[t.c]));
}

double InternalEnergy::bendingDensity(int triple, const std::vector<Vec3>& x) const {
  const Loop& law = bend_[mesh_.triples[triple].direction];
  return law.stored(triple_steps_.empty() ? 0.0 : triple_steps_[triple].play, curvature(triple, x));
}

}  // namespace haptic_cloth
