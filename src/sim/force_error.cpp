#include "sim/force_error.h"

#include <algorithm>
#include <climits>
#include <cmath>

namespace haptic_cloth {
namespace {

constexpr double kReach = 5.0;  // [radii of the probe]
// Fitted to strip_probe, fold_probe and box_probe (bench/force_error), and rounded.
constexpr double kStretchShare = 2.5e-5, kBendShare = 5e-4;
constexpr double kDelay = 0.2;  // [time steps]
// Two references that differ only in time step and tolerance are up to this far apart.
constexpr double kRest = 0.01;

/// Length of an element over that of the finest grid beyond one, both squared [-].
double excess(double squared_length, double spacing) {
  return std::max(0.0, squared_length / (spacing * spacing) - 1.0);
}

}  // namespace

double ForceError::estimate(int probe, const Vec3& unbalanced, const Vec3& before, const Vec3& force) const {
  if (before.isZero(0.0) && force.isZero(0.0)) return 0.0;
  const double coarse = 2.0 * scene_.probes[probe].coupling_stiffness * energy_;
  const double delayed = kDelay * (force - before).norm(), rest = kRest * force.norm();
  return std::sqrt(unbalanced.squaredNorm() + coarse + delayed * delayed + rest * rest);
}

Vec3 ForceError::unbalancedForce(int probe, const ClothObjective& solved, const ActiveMesh& mesh) const {
  const ProbeOptions& options = scene_.probes[probe];
  const double reach = kReach * (options.radius + 0.5 * options.length);
  const Field &x = solved.nodes(), &gradient = solved.gradient();
  const Vec3 proxy = solved.proxy(probe);
  Vec3 sum = Vec3::Zero();
  for (int n = 0; n < mesh.free; ++n) {
    if ((x[n] - proxy).squaredNorm() <= reach * reach) sum -= gradient[n];
  }
  return sum;
}

double ForceError::coarseEnergy(const Cloth& cloth) {
  const ActiveMesh& mesh = cloth.mesh();
  const InternalEnergy& internal = cloth.internal();
  const Field& x = cloth.nodes();
  const double spacing[] = {cloth.grid().dx, cloth.grid().dy};
  double stretch = 0.0, bend = 0.0;
  for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e) {
    const Edge& edge = mesh.edges[e];
    const double coarser = excess(edge.length * edge.length, spacing[edge.direction]);
    if (coarser < 0.5) continue;  // finest
    const double stretched = (x[edge.b] - x[edge.a]).norm() - edge.length;
    stretch += coarser * 0.5 * std::abs(internal.tension(e, x) * stretched) * edge.width;
  }
  for (int t = 0; t < static_cast<int>(mesh.triples.size()); ++t) {
    const Triple& triple = mesh.triples[t];
    const double finest = spacing[triple.direction];
    const double coarser = excess(1.0 / std::sqrt(triple.left * triple.right), finest);
    if (coarser < 0.5) continue;
    const double finest_turn = internal.curvature(t, x) * finest;
    bend += coarser * finest_turn * finest_turn * internal.bendingDensity(t, x) * triple.area;
  }
  return std::max(0.0, kStretchShare * stretch + kBendShare * bend);
}

void ForceError::serialize(Archive& archive) {
  archive.within("force_error.energy", energy_, 0, LONG_MAX / 2);
}

}  // namespace haptic_cloth
