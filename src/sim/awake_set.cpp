#include "sim/awake_set.h"

#include <algorithm>
#include <array>

namespace haptic_cloth {

AwakeSet::AwakeSet(const ActiveMesh& mesh, const InternalEnergy& internal, const ContactSet& contacts)
    : mesh_(mesh), internal_(internal), contacts_(contacts) {
  for (auto* list : {&awake_, &seen_, &reached_}) list->reserve(mesh.grid.particles());
  elements_.reserve(mesh.grid.particles());
  nodes_.reserve(mesh.grid.particles() / kPack + 1);
  element_order_.reserve(NodeGather::capacity(mesh) + contacts.capacity());
}

void AwakeSet::begin() {
  awake_.resize(mesh_.nodes());
  wakeAll();
}

void AwakeSet::sleepAll() {
  std::fill(awake_.begin(), awake_.end(), 0);
  all_ = false;
}

bool AwakeSet::wake(const SleepTracker& sleep) {
  // Rings of cells woken around what moves: pushed cloth pushes its neighbours.
  constexpr int kRings = 3;
  // Share of awake nodes above which all are woken.
  constexpr double kWorthwhile = 0.6;
  bool more = false;
  seen_.assign(mesh_.nodes(), 0);
  for (int n = 0; n < mesh_.free; ++n) {
    seen_[n] = !awake_[n] && !sleep.sleeps(n);
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
    listCovered();
  }
  return true;
}

void AwakeSet::wakeAll() {
  std::fill(awake_.begin(), awake_.end(), 1);
  all_ = true;
  sleepers_square_ = 0.0;
  coverAll();
}

void AwakeSet::coverAll() {
  elements_.clear();
  elements_.add(0, internal_.size() + contacts_.size());
  const auto [warp_edges, weft_edges, warp_triples, weft_triples, patches] = internal_.starts();
  element_order_.set(
      std::array{warp_edges, weft_edges, warp_triples, weft_triples, patches, internal_.size()},
      elements_.size());
  nodes_.clear();
  nodes_.add(0, padded(mesh_.nodes()));
}

void AwakeSet::measureSleepers(const Field& gradient, const Vector& weight) {
  sleepers_square_ = 0.0;
  for (int n = 0; n < mesh_.free; ++n) {
    if (!awake_[n]) sleepers_square_ += gradient[n].squaredNorm() * weight[n];
  }
}

int AwakeSet::count() const {
  return static_cast<int>(std::count(awake_.begin(), awake_.begin() + mesh_.free, 1));
}

void AwakeSet::clearSleepers(Vector& x) const {
  if (all_) return;
  for (int n = 0; n < mesh_.free; ++n) {
    if (awake_[n]) continue;
    for (int c = 0; c < 3; ++c) x[c * mesh_.free + n] = 0.0;
  }
}

/// Extends seen_ by one ring: to all nodes of the cells around seen nodes. Hanging nodes follow
/// their masters.
void AwakeSet::spread() {
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

/// Lists the elements that act on an awake node, and the packs that hold one.
void AwakeSet::listCovered() {
  elements_.clear();
  element_order_.clear();
  internal_.appendAwake(awake_, elements_);
  contacts_.appendAwake(awake_, internal_.size(), elements_);
  nodes_.clear();
  for (int n = 0; n < mesh_.nodes(); n += kPack) {
    const auto first = awake_.begin() + n, last = awake_.begin() + std::min(n + kPack, mesh_.nodes());
    if (std::any_of(first, last, [](char a) { return a != 0; })) nodes_.add(n, n + kPack);
  }
}

}  // namespace haptic_cloth
