#include "sim/contact_reach.h"

#include <algorithm>
#include <cmath>

#include "sim/cloth_objective.h"

namespace haptic_cloth {

ContactReach::ContactReach(const Scene& scene, const Cloth& cloth, const Probes& probes)
    : scene_(scene), cloth_(cloth), probes_(probes), proxies_(probes.count(), 0.0) {
  nodes_.reserve(cloth.grid().particles());
  nodes_.assign(cloth.mesh().nodes(), 0.0);
}

void ContactReach::estimate() {
  const double h = cloth_.integrator().stepLength();
  const Grid& grid = cloth_.grid();
  nodes_.resize(cloth_.mesh().nodes());
  for (int n = 0; n < cloth_.mesh().nodes(); ++n) {
    nodes_[n] = 2.0 * h * (cloth_.velocities()[n].norm() + h * scene_.gravity.norm()) +
                0.1 * std::min(grid.dx, grid.dy);
  }
  for (int k = 0; k < probes_.count(); ++k) {
    const ProbeStep& probe = probes_.steps()[k];
    // Cloth usually keeps holding back a proxy whose device is far ahead. Without a time limit the
    // reach therefore leaves out most of that distance: if the cloth lets go, the step is solved
    // again.
    double distance = (probe.device - probe.proxy).norm();
    if (scene_.solver.minimizer.time_budget == 0.0) distance = std::min(distance, scene_.probes[k].radius);
    proxies_[k] = distance + 2.0 * h * probes_.reports()[k].velocity.norm();
  }
}

bool ContactReach::covers(const ClothObjective& solved) {
  const bool nodes_covered = coversNodes(solved), proxies_covered = coversProxies(solved);
  return nodes_covered && proxies_covered;
}

bool ContactReach::coversNodes(const ClothObjective& solved) {
  bool all = true;
  for (int n = 0; n < cloth_.mesh().nodes(); ++n) {
    const double squared = (solved.nodes()[n] - cloth_.nodes()[n]).squaredNorm();
    if (4.0 * squared <= nodes_[n] * nodes_[n]) continue;
    const double moved = std::sqrt(squared);
    all = all && !(moved > nodes_[n]);
    nodes_[n] = std::max(nodes_[n], 2.0 * moved);
  }
  return all;
}

bool ContactReach::coversProxies(const ClothObjective& solved) {
  bool all = true;
  for (int k = 0; k < probes_.count(); ++k) {
    if (!probes_.isPresent(k)) continue;
    const double moved = (solved.proxy(k) - probes_.steps()[k].proxy).norm();
    all = all && !(moved > proxies_[k]);
    proxies_[k] = std::max(proxies_[k], 2.0 * moved);
  }
  return all;
}

}  // namespace haptic_cloth
