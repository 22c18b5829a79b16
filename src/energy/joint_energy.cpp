#include "energy/joint_energy.h"

#include <algorithm>
#include <cmath>

#include "energy/shear.h"
#include "energy/twist.h"

namespace haptic_cloth {
namespace {

using Kind = InternalEnergy::Kind;

}  // namespace

JointEnergy::JointEnergy(const InternalEnergy& laws, const ActiveMesh& mesh) : laws_(laws), mesh_(mesh) {
  elements_.reserve(mesh.edges.capacity() + mesh.triples.capacity() + mesh.patches.capacity());
  slots_.reserve(NodeGather::capacity(mesh));
}

void JointEnergy::begin(const Field& x, double* forces) {
  // Lower bound of a law's slope, relative to that at large deformation; a toe may start without
  // slope.
  constexpr double kLeast = 1e-3;
  elements_.resize(size());
  slots_.clear(laws_.gather().slots());
  for (int k = 0; k < size(); ++k) {
    const Curve::Point law = laws_.law(k, laws_.deformation(k, x));
    const double floor = kLeast * laws_.law(k, 1e9).slope;
    const double slope = std::max(law.slope, floor);
    elements_[k].area = laws_.area(k);
    // No law: the force stays zero.
    elements_[k].scale = elements_[k].area / (slope > 0.0 ? slope : 1.0);
    forces[k] = law.force;
  }
}

JointEnergy::Slope JointEnergy::slopeAt(int element, const Field& x) const {
  const auto [kind, k] = laws_.kind(element);
  if (kind == Kind::Edge) {
    const Edge& edge = mesh_.edges[k];
    const Vec3 span = x[edge.b] - x[edge.a];
    const double now = span.norm();
    return {now > 0.0 ? Vec3(span / (now * edge.length)) : Vec3::Zero(), Vec3::Zero()};
  }
  if (kind == Kind::Triple) return {laws_.normal(mesh_.triples[k].c), Vec3::Zero()};
  const Patch& patch = mesh_.patches[k];
  const ShearSlope slope = Shear(corners(patch, x), patch.area).slope();
  return {slope.rising, slope.falling};
}

/// Change of slopeAt(x) along d; triples bend about normals that are held within a step.
JointEnergy::Slope JointEnergy::slopeChange(int element, const Field& x, const Field& d) const {
  const auto [kind, k] = laws_.kind(element);
  if (kind == Kind::Edge) {
    const Edge& edge = mesh_.edges[k];
    const double now = (x[edge.b] - x[edge.a]).norm();
    if (!(now > 0.0)) return {Vec3::Zero(), Vec3::Zero()};
    const Vec3 axis = edge.length * elements_[element].slope[0], change = d[edge.b] - d[edge.a];
    return {(change - axis.dot(change) * axis) / (now * edge.length), Vec3::Zero()};
  }
  if (kind == Kind::Triple) return {Vec3::Zero(), Vec3::Zero()};
  const Patch& patch = mesh_.patches[k];
  const ShearSlope change = Shear(corners(patch, x), patch.area).slopeChange(corners(patch, d));
  return {change.rising, change.falling};
}

/// Derivative of the deformation along d.
double JointEnergy::rate(int element, const Field& d) const {
  const auto [kind, k] = laws_.kind(element);
  const Slope& slope = elements_[element].slope;
  if (kind == Kind::Edge) return slope[0].dot(d[mesh_.edges[k].b] - d[mesh_.edges[k].a]);
  if (kind == Kind::Triple) return slope[0].dot(mesh_.triples[k].bent(d));
  const auto& n = mesh_.patches[k].nodes;
  return slope[0].dot(d[n[3]] - d[n[0]]) + slope[1].dot(d[n[1]] - d[n[2]]);
}

/// Writes an element's vectors to its slots, and the twist force for the vectors `twisted`, in
/// which it is linear.
void JointEnergy::put(int element, const Slope& value, const Field& twisted) {
  const auto [kind, k] = laws_.kind(element);
  const NodeGather& gather = laws_.gather();
  if (kind == Kind::Edge) {
    slots_.set(gather.edges().place(k), value[0]);
  } else if (kind == Kind::Triple) {
    slots_.set(gather.firstTriple() + gather.triples().place(k), value[0]);
  } else {
    slots_.set(gather.firstPatch() + k, value[0]);
    slots_.set(gather.firstPatch() + gather.patches().size() + k, value[1]);
    if (!(laws_.twist() > 0.0)) return;
    const Vec3 normal = laws_.patchNormal(k);
    const TwistResult twist =
        evaluateTwist(corners(mesh_.patches[k], twisted), normal, laws_.twist(), mesh_.patches[k].area);
    slots_.set(gather.firstTwist() + k, twist.gradient * normal);
  }
}

JointEnergy::Costs JointEnergy::evaluate(int begin, int end, const Field& x, const double* forces) {
  Costs costs;
  for (int k = begin; k < end; ++k) {
    Element& element = elements_[k];
    const Curve::Point law = laws_.law(k, laws_.deformation(k, x));
    element.force = forces[k];
    element.missing = forces[k] - law.force;
    element.rise = law.slope;
    element.slope = slopeAt(k, x);
    const double load = element.area * element.force;
    put(k, {load * element.slope[0], load * element.slope[1]}, x);
    const double cost = 0.5 * element.scale * element.missing * element.missing;
    const Kind kind = laws_.kind(k).first;
    (kind == Kind::Edge ? costs.stretch : kind == Kind::Triple ? costs.bend : costs.shear) += cost;
  }
  return costs;
}

double JointEnergy::linearise(int begin, int end, const Field& x, const Field& d, const double* d_forces) {
  double quadratic_form = 0.0;
  for (int k = begin; k < end; ++k) {
    const Element& element = elements_[k];
    const Slope change = slopeChange(k, x, d);
    const double load = element.area * element.force, more = element.area * d_forces[k];
    put(k, {load * change[0] + more * element.slope[0], load * change[1] + more * element.slope[1]}, d);
    const double missing = d_forces[k] - element.rise * rate(k, d);
    quadratic_form += element.scale * missing * missing;
  }
  return quadratic_form;
}

void JointEnergy::gradient(int begin, int end, const Field& x, const Field& u, double* gradient) {
  for (int k = begin; k < end; ++k) {
    const Element& element = elements_[k];
    const Slope change = slopeChange(k, x, u);
    const double load = element.area * element.force, pull = element.scale * element.missing;
    const double back = pull * element.rise;
    put(k, {load * change[0] - back * element.slope[0], load * change[1] - back * element.slope[1]}, u);
    gradient[k] = element.area * rate(k, u) + pull;
  }
}

void JointEnergy::diagonal(const std::vector<double>& weights, Field& laws, Field& force_change,
                           double* forces) const {
  for (int k = 0; k < size(); ++k) {
    const Element& element = elements_[k];
    const double stiffness = element.scale * element.rise * element.rise;
    double weight = 0.0;
    const auto visit = [&](int node, double coefficient, const Vec3& slope) {
      laws.add(node, coefficient * coefficient * stiffness * slope.cwiseAbs2());
      weight += weights[node] * coefficient * coefficient * slope.squaredNorm();
    };
    const auto [kind, index] = laws_.kind(k);
    if (kind == Kind::Edge) {
      const Edge& edge = mesh_.edges[index];
      const Vec3 axis = edge.length * element.slope[0];
      const Vec3 across =
          std::max(element.force, 0.0) * edge.width / edge.length * (Vec3::Ones() - axis.cwiseAbs2());
      for (const int node : {edge.a, edge.b}) {
        visit(node, 1.0, element.slope[0]);
        force_change.add(node, across);
      }
    } else if (kind == Kind::Triple) {
      for (const auto& [node, coefficient] : mesh_.triples[index].parts()) {
        visit(node, coefficient, element.slope[0]);
      }
    } else {
      const auto& n = mesh_.patches[index].nodes;
      for (const int node : {n[0], n[3]}) visit(node, 1.0, element.slope[0]);
      for (const int node : {n[1], n[2]}) visit(node, 1.0, element.slope[1]);
    }
    forces[k] = element.area * element.area * weight + element.scale;
  }
}

}  // namespace haptic_cloth
