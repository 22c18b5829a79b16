#include "sim/contact_reach.h"

#include <algorithm>
#include <cmath>

#include "sim/cloth_objective.h"

namespace haptic_cloth {
namespace {

/// Tells whether a motion is within reach; widens a reach that it nearly uses up.
bool isWithin(const Vec3& motion, double& reach) {
  const double squared = motion.squaredNorm();
  if (4.0 * squared <= reach * reach) return true;
  const double moved = std::sqrt(squared);
  const bool within = !(moved > reach);
  reach = std::max(reach, 2.0 * moved);
  return within;
}

}  // namespace

ContactReach::ContactReach(const Scene& scene, const Cloth& cloth, const Probes& probes)
    : scene_(scene), cloth_(cloth), probes_(probes), proxies_(probes.count(), 0.0) {
  nodes_.reserve(cloth.grid().particles());
  deviation_.reserve(cloth.grid().particles());
  motion_.reserve(cloth.grid().particles());
  nodes_.assign(cloth.mesh().nodes(), 0.0);
  deviation_ = nodes_;
  motion_.clear(cloth.mesh().nodes());
}

void ContactReach::estimate() {
  const double h = cloth_.integrator().stepLength();
  const Grid& grid = cloth_.grid();
  const int count = cloth_.mesh().nodes();
  const double spacing = grid.shortestSpacing(), gravity = scene_.gravity.norm();
  nodes_.resize(count);
  deviation_.resize(count);
  motion_.resize(count);
  for (int n = 0; n < count; ++n) {
    const Vec3 moves = h * cloth_.velocities()[n];
    nodes_[n] = 2.0 * (moves.norm() + h * h * gravity) + 0.1 * spacing;
    motion_.set(n, moves);
    deviation_[n] = std::min(0.05 * moves.norm() + 0.5 * h * h * gravity, spacing) + 0.01 * spacing;
  }
  for (int k = 0; k < probes_.count(); ++k) {
    const ProbeStep& probe = probes_.steps()[k];
    // Cloth usually keeps holding back a proxy whose device is far ahead. The reach therefore leaves out
    // most of that distance: if the cloth lets go, the step is solved again.
    const ProbeOptions& options = scene_.probes[k];
    const double turn = probe.turns ? probe.orientation.angularDistance(probe.device_orientation) : 0.0;
    const double ahead = (probe.device - probe.proxy).norm() + options.extent() * turn;
    const double speed = probes_.reports()[k].velocity.norm() + options.extent() * probes_.spin(k).norm();
    proxies_[k] = std::min(ahead, options.radius) + 2.0 * h * speed;
  }
}

bool ContactReach::covers(const ClothObjective& solved) {
  const bool nodes_covered = coversNodes(solved), proxies_covered = coversProxies(solved);
  return nodes_covered && proxies_covered;
}

bool ContactReach::coversPairs(const ClothObjective& solved) {
  bool all = true;
  for (int n = 0; n < cloth_.mesh().nodes(); ++n) {
    const Vec3 moves = solved.nodes()[n] - cloth_.nodes()[n];
    const bool within = !((moves - motion_[n]).norm() > deviation_[n]);
    if (!within) deviation_[n] *= 2.0;
    motion_.set(n, moves);
    all = all && within;
  }
  return all;
}

bool ContactReach::coversNodes(const ClothObjective& solved) {
  bool all = true;
  for (int n = 0; n < cloth_.mesh().nodes(); ++n) {
    all = isWithin(solved.nodes()[n] - cloth_.nodes()[n], nodes_[n]) && all;
  }
  return all;
}

bool ContactReach::coversProxies(const ClothObjective& solved) {
  bool all = true;
  for (int k = 0; k < probes_.count(); ++k) {
    if (!probes_.isPresent(k)) continue;
    const double moved = (solved.proxy(k) - probes_.steps()[k].proxy).norm() +
                         scene_.probes[k].extent() * solved.turn(k).norm();
    all = all && !(moved > proxies_[k]);
    proxies_[k] = std::max(proxies_[k], 2.0 * moved);
  }
  return all;
}

}  // namespace haptic_cloth
