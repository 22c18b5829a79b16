#include "sim/force_error.h"

#include <algorithm>
#include <climits>
#include <cmath>

namespace haptic_cloth {
namespace {

constexpr double kReach = 3.0;      // [extents of the probe]
constexpr double kMemory = 0.02;    // motion by which U_past fades to 1/e [radii of the probe]
constexpr double kPastShare = 0.5;  // [-]
// Fitted to scenes of bench/force_error, and rounded.
constexpr double kStretchShare = 2.5e-5, kBendShare = 4e-4;
constexpr double kStretchError = 0.012;
constexpr double kDelay = 0.2;  // [time steps]
// Two references that differ only in time step and tolerance are up to this far apart.
constexpr double kRest = 0.015;

/// Length of an element over that of the finest grid beyond one, both squared [-]. Finest elements
/// have none, whatever rounding says.
double excess(double squared_length, double spacing) {
  const double excess = squared_length / (spacing * spacing) - 1.0;
  return excess < 0.5 ? 0.0 : excess;
}

}  // namespace

double ForceError::estimate(int probe, double moved, double unbalanced, const Vec3& before,
                            const Vec3& force) {
  if (before.isZero(0.0) && force.isZero(0.0)) return past_[probe] = 0.0;
  past_[probe] *= std::exp(-moved / (kMemory * scene_.probes[probe].radius));
  const double unfinished = std::max(unbalanced, kPastShare * past_[probe]);
  past_[probe] = std::max(past_[probe], unbalanced);
  const double stiffness = scene_.probes[probe].coupling_stiffness;
  double stretched = 2.0 * stiffness * kStretchShare * coarse_.stretch;
  if (stretched > 0.0) {
    const double relative = kStretchError * coarse_.stretch / coarse_.whole;
    stretched = std::min(stretched, relative * relative * force.squaredNorm());
  }
  const double bent = 2.0 * stiffness * kBendShare * coarse_.bend;
  const double delayed = kDelay * (force - before).norm(), rest = kRest * force.norm();
  return std::sqrt(unfinished * unfinished + stretched + bent + delayed * delayed + rest * rest);
}

double ForceError::unbalancedForce(int probe, const ClothObjective& solved, const ActiveMesh& mesh) const {
  const ProbeOptions& options = scene_.probes[probe];
  const double reach = kReach * options.extent();
  const Field &x = solved.nodes(), &gradient = solved.gradient();
  const Vec3 proxy = solved.proxy(probe);
  Vec3 sum = Vec3::Zero();
  for (int n = 0; n < mesh.free; ++n) {
    if ((x[n] - proxy).squaredNorm() <= reach * reach) sum -= gradient[n];
  }
  return std::max(sum.norm(), solved.proxyGradient(probe).norm());
}

void ForceError::noteCloth(const Cloth& cloth, bool felt, bool decision) {
  if (felt && (decision || !felt_)) coarse_ = coarseEnergy(cloth);
  felt_ = felt;
}

ForceError::CoarseEnergy ForceError::coarseEnergy(const Cloth& cloth) {
  const ActiveMesh& mesh = cloth.mesh();
  const InternalEnergy& internal = cloth.internal();
  const Field& x = cloth.nodes();
  const double spacing[] = {cloth.grid().dx, cloth.grid().dy};
  CoarseEnergy sum;
  for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e) {
    const Edge& edge = mesh.edges[e];
    const double stretched = (x[edge.b] - x[edge.a]).norm() - edge.length;
    const double energy = 0.5 * std::abs(internal.tension(e, x) * stretched) * edge.width;
    sum.stretch += excess(edge.length * edge.length, spacing[edge.direction]) * energy;
    sum.whole += energy;
  }
  for (int t = 0; t < static_cast<int>(mesh.triples.size()); ++t) {
    const Triple& triple = mesh.triples[t];
    const double finest = spacing[triple.direction];
    const double finest_turn = internal.curvature(t, x) * finest;
    const double energy = std::max(0.0, internal.bendingDensity(t, x) * triple.area);
    sum.bend += excess(triple.length * triple.length, finest) * finest_turn * finest_turn * energy;
    sum.whole += energy;
  }
  return sum;
}

void ForceError::CoarseEnergy::serialize(Archive& archive) {
  archive.within("stretch", stretch, 0, LONG_MAX / 2);
  archive.within("bend", bend, 0, LONG_MAX / 2);
  archive.within("whole", whole, 0, LONG_MAX / 2);
}

void ForceError::serialize(Archive& archive) {
  archive("force_error.coarse", coarse_);
  archive("force_error.felt", felt_);
  archive.within("force_error.past", past_, 0, LONG_MAX / 2);
}

}  // namespace haptic_cloth
