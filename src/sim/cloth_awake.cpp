// Part of ClothObjective that manages sleeping nodes.
#include <algorithm>
#include <cmath>

#include "sim/cloth_objective.h"

namespace haptic_cloth {

void ClothObjective::lookAtAll() {
  awake_elements_.clear();
  awake_elements_.add(0, internal_.size() + contacts_.size());
  awake_nodes_.clear();
  awake_nodes_.add(0, padded(mesh_.nodes()));
}

void ClothObjective::sleepAll() {
  std::fill(awake_.begin(), awake_.end(), 0);
  all_awake_ = false;
}

int ClothObjective::awake() const {
  return static_cast<int>(std::count(awake_.begin(), awake_.begin() + mesh_.free, 1));
}

void ClothObjective::forcesAtRest(const Field& velocities, Field& forces) const {
  forces = gradient_;
  for (int c = 0; c < 3; ++c) {
    const auto& v = velocities.coordinate(c);
    auto& force = forces.coordinate(c);
    for (int n = 0; n < mesh_.free; ++n) force[n] += moving_mass_[n] / h_ * v[n];
  }
}

bool ClothObjective::wake(const Rest& rest) {
  // Rings of cells woken around what moves: pushed cloth pushes its neighbours.
  constexpr int kRings = 3;
  // Share of awake nodes above which all are woken.
  constexpr double kWorthwhile = 0.6;
  bool more = false;
  seen_.assign(mesh_.nodes(), 0);
  for (int n = 0; n < mesh_.free; ++n) {
    seen_[n] = !awake_[n] && !rest.sleeps(n);
    more = more || seen_[n];
  }
  if (!more) return false;
  for (int ring = 0; ring < kRings; ++ring) spread();
  int count = 0;
  for (int n = 0; n < mesh_.nodes(); ++n) {
    awake_[n] = awake_[n] || seen_[n];
    count += awake_[n];
  }
  if (count > kWorthwhile * mesh_.nodes()) {
    wakeAll();
  } else {
    listAwake();
  }
  return true;
}

void ClothObjective::wakeAll() {
  std::fill(awake_.begin(), awake_.end(), 1);
  all_awake_ = true;
  asleep_square_ = 0.0;
  lookAtAll();
}

void ClothObjective::measureSleepers() {
  asleep_square_ = 0.0;
  for (int n = 0; n < mesh_.free; ++n) {
    if (!awake_[n]) asleep_square_ += gradient_[n].squaredNorm() * residual_weight_[n];
  }
}

/// Extends seen_ by one ring: to all nodes of the cells around seen nodes. Hanging nodes follow
/// their masters.
void ClothObjective::spread() {
  reached_.assign(mesh_.nodes(), 0);
  for (const Patch& patch : mesh_.patches) {
    const auto& n = patch.nodes;
    if (!(seen_[n[0]] || seen_[n[1]] || seen_[n[2]] || seen_[n[3]])) continue;
    for (const int node : n) reached_[node] = 1;
  }
  for (auto g = mesh_.ghosts.rbegin(); g != mesh_.ghosts.rend(); ++g) {
    if (reached_[g->node]) reached_[g->a] = reached_[g->b] = 1;
  }
  for (const Ghost& g : mesh_.ghosts) reached_[g.node] = reached_[g.a] || reached_[g.b];
  seen_.swap(reached_);
}

void ClothObjective::listAwake() {
  awake_elements_.clear();
  internal_.appendAwake(awake_, awake_elements_);
  contacts_.appendAwake(awake_, internal_.size(), awake_elements_);
  awake_nodes_.clear();
  for (int n = 0; n < mesh_.nodes(); n += kPack) {
    const auto first = awake_.begin() + n, last = awake_.begin() + std::min(n + kPack, mesh_.nodes());
    if (std::any_of(first, last, [](char a) { return a != 0; })) awake_nodes_.add(n, n + kPack);
  }
}

}  // namespace haptic_cloth
