#include "sim/layer_binding.h"

#include <algorithm>

#include "sim/node_entry.h"

namespace haptic_cloth {
namespace {

/// Trace of the product of two symmetric matrices.
double traceOfProduct(const Block& a, const Block& b) {
  return a.head<3>().dot(b.head<3>()) + 2.0 * a.tail<3>().dot(b.tail<3>());
}

}  // namespace

LayerBinding::LayerBinding(const ActiveMesh& mesh) : mesh_(mesh) {
  const int particles = mesh.grid.particles();
  for (auto* list : {&ghost_of_, &row_of_, &bound_}) list->reserve(particles);
  factor_.reserve(particles);
  values_.reserve(particles);
  ends_.reserve(64);
}

void LayerBinding::fit(const SelfContact& layers, const Blocks& elements, const Blocks& others,
                       const BlockField& inverse, const Field& nodes) {
  const auto own = [&](int n) -> Block { return elements[n] + others[n]; };
  // A pair is stiff if it is so beside the block of one of its nodes, in the directions in which it acts.
  constexpr double kStiff = 0.1;
  const auto is_stiff = [&](const Block& stiffness) {
    const double trace = stiffness.head<3>().sum();
    return std::any_of(ends_.begin(), ends_.end(), [&](const BlockFactor::End& end) {
      return end.weight * end.weight * trace * trace > kStiff * traceOfProduct(stiffness, own(end.row));
    });
  };
  factor_.clear();
  bound_.clear();
  row_of_.assign(mesh_.nodes(), -1);
  ghost_of_.resize(mesh_.nodes());
  for (std::size_t k = 0; k < mesh_.ghosts.size(); ++k) ghost_of_[mesh_.ghosts[k].node] = static_cast<int>(k);
  constexpr double kNearest = 0.1;  // [ranges]; nearer pairs get softer before the next fit
  layers.forSprings(kNearest, [&](const PairPoints& pair, int lane, const Block& stiffness) {
    ends_.clear();
    forNodes(pair, lane, [&](int n, double weight) { addMasters(n, weight, inverse); });
    if (!is_stiff(stiffness)) return;
    for (BlockFactor::End& end : ends_) {
      int& row = row_of_[end.row];
      if (row < 0) {
        row = factor_.addRow(own(end.row), nodes[end.row]);
        bound_.push_back(end.row);
      }
      end.row = row;
    }
    factor_.addSpring(stiffness, ends_);
  });
  if (!factor_.factor()) bound_.clear();
}

/// Adds a node that moves to the ends of a pair; of a hanging node its masters.
void LayerBinding::addMasters(int node, double weight, const BlockField& inverse) {
  if (weight == 0.0) return;
  if (node >= mesh_.active()) {
    const Ghost& ghost = mesh_.ghosts[ghost_of_[node]];
    addMasters(ghost.a, 0.5 * weight, inverse);
    addMasters(ghost.b, 0.5 * weight, inverse);
  } else if (node < mesh_.free && inverse[node][0] > 0.0) {
    const auto same =
        std::find_if(ends_.begin(), ends_.end(), [node](const auto& e) { return e.row == node; });
    if (same == ends_.end()) {
      ends_.push_back({node, weight});
    } else {
      same->weight += weight;
    }
  }
}

void LayerBinding::apply(const BlockField& inverse, const Vector& gradient, Vector& z) {
  if (bound_.empty()) return;
  values_.clear();
  for (const int n : bound_) values_.push_back(entryOf(gradient, mesh_.free, n));
  factor_.solve(values_);
  for (std::size_t k = 0; k < bound_.size(); ++k) {
    const int n = bound_[k];
    addEntry(z, mesh_.free, n, values_[k] - product(inverse[n], entryOf(gradient, mesh_.free, n)));
  }
}

}  // namespace haptic_cloth
