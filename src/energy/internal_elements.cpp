// The part of InternalEnergy that deals with one element at a time.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"
#include "energy/shear.h"

namespace haptic_cloth {

Loop::Step InternalEnergy::edgeStep(int edge) const {
  return edge_steps_.packs() ? edge_steps_.get(gather_.edges().place(edge)) : Loop::Step{};
}

Loop::Step InternalEnergy::tripleStep(int triple) const {
  return triple_steps_.packs() ? triple_steps_.get(gather_.triples().place(triple)) : Loop::Step{};
}

Loop::Step InternalEnergy::patchStep(int patch) const {
  return patch_steps_.packs() ? patch_steps_.get(patch) : Loop::Step{};
}

double InternalEnergy::strain(int edge, const Field& x) const {
  const Edge& e = mesh_.edges[edge];
  return (x[e.b] - x[e.a]).norm() / e.length - 1.0;
}

double InternalEnergy::curvature(int triple, const Field& x) const {
  const Triple& t = mesh_.triples[triple];
  return normal(t.c).dot(t.left * (x[t.l] - x[t.c]) + t.right * (x[t.r] - x[t.c]));
}

double InternalEnergy::shearAngle(int patch, const Field& x) const {
  return haptic_cloth::shearAngle(corners(patch, x));
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
