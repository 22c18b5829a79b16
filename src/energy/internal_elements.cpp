// Part of InternalEnergy that handles single elements.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"
#include "energy/shear.h"
#include "energy/twist.h"

namespace haptic_cloth {
namespace {

double strainOf(const Edge& edge, const Field& x) {
  return (x[edge.b] - x[edge.a]).norm() / edge.length - 1.0;
}

double curvatureOf(const Triple& t, const Vec3& normal, const Field& x) {
  return normal.dot(t.left * (x[t.l] - x[t.c]) + t.right * (x[t.r] - x[t.c]));
}

}  // namespace

double InternalEnergy::strain(int edge, const Field& x) const { return strainOf(mesh_.edges[edge], x); }

double InternalEnergy::curvature(int triple, const Field& x) const {
  return curvatureOf(mesh_.triples[triple], normal(mesh_.triples[triple].c), x);
}

double InternalEnergy::shearAngle(int patch, const Field& x) const {
  return haptic_cloth::shearAngle(corners(mesh_.patches[patch], x));
}

double InternalEnergy::stored(const Edge& edge, double play, const Field& x) const {
  return edge.length * edge.width * stretch_[edge.direction].stored(play, strainOf(edge, x));
}

double InternalEnergy::stored(const Triple& triple, double play, const Vec3& normal, const Field& x) const {
  return triple.area * bend_[triple.direction].stored(play, curvatureOf(triple, normal, x));
}

InternalEnergy::Energy InternalEnergy::stored(const Patch& patch, double play, const Vec3& normal,
                                              const Field& x) const {
  const auto at = corners(patch, x);
  Energy energy;
  energy.shear = patch.area * shear_.stored(play, haptic_cloth::shearAngle(at));
  if (twist_rigidity_ > 0.0) energy.bend = evaluateTwist(at, normal, twist_rigidity_, patch.area).energy;
  return energy;
}

double InternalEnergy::deformation(int element, const Field& x) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return strain(k, x);
  return kind == Kind::Triple ? curvature(k, x) : shearAngle(k, x);
}

Curve::Point InternalEnergy::law(int element, double deformation) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return stretch_[mesh_.edges[k].direction](edgeStep(k), deformation);
  if (kind == Kind::Patch) return shear_(patchStep(k), deformation);
  return bend_[mesh_.triples[k].direction](tripleStep(k), deformation);
}

double InternalEnergy::area(int element) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return mesh_.edges[k].length * mesh_.edges[k].width;
  return kind == Kind::Triple ? mesh_.triples[k].area : mesh_.patches[k].area;
}

double InternalEnergy::maxStrain(const Field& x) const {
  double largest = 0.0;
  for (int e = 0; e < edge_count_; ++e) largest = std::max(largest, std::abs(strain(e, x)));
  return largest;
}

double InternalEnergy::tension(int edge, const Field& x) const {
  return stretch_[mesh_.edges[edge].direction](edgeStep(edge), strain(edge, x)).force;
}

double InternalEnergy::bendingDensity(int triple, const Field& x) const {
  const Loop& law = bend_[mesh_.triples[triple].direction];
  return law.stored(triple < triple_count_ ? tripleStep(triple).play : 0.0, curvature(triple, x));
}

}  // namespace haptic_cloth
