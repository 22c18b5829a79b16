#include "sim/adaptation.h"

#include <algorithm>

namespace haptic_cloth {

Adaptation::Adaptation(const AdaptOptions& options, const Grid& grid)
    : options_(options),
      grid_(grid),
      edge_means_(grid.particles()),
      born_(grid.cells(), kLongAgo),
      decided_below_(options.far_angle_factor * options.coarsen_below),
      decided_below_strain_(options.far_strain_factor * options.coarsen_below_strain),
      crowded_(grid.cells(), 0),
      splits_(grid.cells(), 0),
      merge_transfer_(grid) {
  for (auto* list : {&leaves_, &marked_, &merged_, &split_}) list->reserve(grid.cells());
  for (auto& strains : strain_) strains.reserve(grid.particles());
}

int Adaptation::startLevel(const AdaptOptions& options) {
  const bool chosen = options.strategy == Strategy::Amrc && options.start == StartMesh::Coarsest;
  const bool coarse = options.strategy == Strategy::Coarsest || options.strategy == Strategy::Refine;
  return chosen || coarse ? options.levels : 0;
}

bool Adaptation::refines() const {
  return options_.strategy == Strategy::Amrc || options_.strategy == Strategy::Refine;
}

bool Adaptation::coarsens() const {
  return options_.strategy == Strategy::Amrc || options_.strategy == Strategy::Coarsen;
}

bool Adaptation::startDecision(long tick) {
  if (decided_ != kNever && tick / options_.interval == decided_ / options_.interval) return false;
  const double below = options_.far_angle_factor * options_.coarsen_below,
               below_strain = options_.far_strain_factor * options_.coarsen_below_strain;
  const bool coarser = below > decided_below_ || below_strain > decided_below_strain_;
  if (coarser) std::fill(born_.begin(), born_.end(), kLongAgo);
  decided_ = tick;
  decided_below_ = below;
  decided_below_strain_ = below_strain;
  return true;
}

bool Adaptation::plan(const View& view) {
  measureStrain(view.nodes, view.mesh);
  view.leaves.leaves(leaves_);
  marked_.clear();
  merged_.clear();
  for (const Cell& cell : leaves_) {
    if (refines() && cell.level > 0 && maySplit(view, cell)) marked_.push_back(cell);
  }
  for (const Cell& cell : leaves_) {
    if (!coarsens() || !hasParent(cell)) continue;
    const Cell parent{cell.i, cell.j, cell.level + 1};
    if (mayMerge(view, parent)) merged_.push_back(parent);
  }
  findSplits(view.leaves);
  for (const Cell& cell : split_)
    crowded_[grid_.cell(cell.i, cell.j)] =
        !view.room(cell, 1, movedBySplit(grid_, cell, view.state.position));
  merged_.erase(std::remove_if(merged_.begin(), merged_.end(),
                               [&](const Cell& parent) { return touchesSplit(parent, view.leaves); }),
                merged_.end());
  return !marked_.empty() || !merged_.empty();
}

void Adaptation::apply(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state) {
  split_.clear();
  if (!merged_.empty()) mergeCells(tick, leaves, mesh, state);
  if (!marked_.empty()) splitCells(tick, leaves, mesh, state);
}

/// Calls visit(i, j) for a finest cell in each leaf that touches a cell of the same level or a finer one.
template <class Visit>
void Adaptation::forNeighbours(const Cell& cell, const Visit& visit) const {
  const int s = cell.span();
  for (const int j : {cell.j - 1, cell.j, cell.j + s}) {
    for (const int i : {cell.i - 1, cell.i, cell.i + s}) {
      if (i >= 0 && j >= 0 && i <= grid_.columns - 2 && j <= grid_.rows - 2) visit(i, j);
    }
  }
}

bool Adaptation::touches(const ProbeRegions& probes, double ProbeRegion::*radius, const Cell& cell,
                         const std::vector<Vec3>& positions) const {
  if (probes.empty()) return false;
  const auto c = cell.corners(grid_);
  const Vec3 centre = 0.25 * (positions[c[0]] + positions[c[1]] + positions[c[2]] + positions[c[3]]);
  const double reach = 0.71 * cell.length(grid_);
  return std::any_of(probes.begin(), probes.end(), [&](const ProbeRegion& probe) {
    return (centre - probe.centre).norm() < probe.*radius + reach;
  });
}

bool Adaptation::hasFarFactors() const {
  return options_.far_angle_factor > 1.0 || options_.far_strain_factor > 1.0;
}

/// Thresholds at a cell, from those near a probe.
Adaptation::Thresholds Adaptation::thresholdsOf(const View& view, const Thresholds& near, const Cell& cell,
                                                int parts) const {
  if (!hasFarFactors() || touches(view.probes, &ProbeRegion::near_radius, cell, view.state.position) ||
      view.carries(cell, parts))
    return near;
  return {options_.far_angle_factor * near.turn, options_.far_strain_factor * near.strain};
}

void Adaptation::measureStrain(const Field& nodes, const ActiveMesh& mesh) {
  const auto strain = [&](int e) {
    const Edge& edge = mesh.edges[e];
    return std::max(0.0, (nodes[edge.b] - nodes[edge.a]).norm() / edge.length - 1.0);
  };
  for (const int direction : {kWarp, kWeft}) edge_means_.compute(mesh, direction, strain, strain_[direction]);
}

/// Largest difference of strain, in one direction, among the particles at a cell's corners (parts 1) or at
/// the corners of its four children (parts 2).
double Adaptation::strainDifference(const Cell& cell, int parts, const ActiveMesh& mesh) const {
  double difference = 0.0;
  const int step = cell.span() / parts;
  for (const std::vector<double>& strains : strain_) {
    double least = strains[mesh.node[grid_.particle(cell.i, cell.j)]], most = least;
    for (int j = 0; j <= parts; ++j) {
      for (int i = 0; i <= parts; ++i) {
        const double strain = strains[mesh.node[grid_.particle(cell.i + i * step, cell.j + j * step)]];
        least = std::min(least, strain);
        most = std::max(most, strain);
      }
    }
    difference = std::max(difference, most - least);
  }
  return difference;
}

/// Strain by which the middle lines of a cell are shorter than its sides, which are not parallel if it is
/// twisted. A split would store the energy of that strain at once.
double Adaptation::shortening(const Cell& cell, const std::vector<Vec3>& positions) const {
  const auto c = cell.corners(grid_);
  const auto between = [&](int a0, int b0, int a1, int b1) {
    const Vec3 side = positions[b0] - positions[a0], opposite = positions[b1] - positions[a1];
    const double sides = side.norm() + opposite.norm();
    return sides > 0.0 ? 1.0 - (side + opposite).norm() / sides : 0.0;
  };
  return std::max(between(c[0], c[1], c[2], c[3]), between(c[0], c[2], c[1], c[3]));
}

/// Tells whether a cell may merge with siblings; only the lower left one of four answers yes.
bool Adaptation::hasParent(const Cell& cell) const {
  const int mask = 2 * cell.span() - 1;
  return cell.level < grid_.levels && (cell.i & mask) == 0 && (cell.j & mask) == 0;
}

/// Makes the planned merges. All were decided from one mesh, so their order does not matter. They
/// keep the mesh balanced: no merging parent has a neighbour finer than its children, so neighbours
/// still differ by at most one level.
void Adaptation::mergeCells(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state) {
  merge_transfer_.capture(mesh);
  for (const Cell& parent : merged_) {
    leaves.merge(parent);
    born_[grid_.cell(parent.i, parent.j)] = tick;
  }
  mesh.rebuild(leaves);
  merge_transfer_.apply(leaves, mesh, state);
}

bool Adaptation::maySplit(const View& view, const Cell& cell) const {
  const std::vector<Vec3>& positions = view.state.position;
  const Thresholds most = thresholdsOf(view, {options_.refine_above, options_.refine_above_strain}, cell, 1);
  return strainDifference(cell, 1, view.mesh) > most.strain || shortening(cell, positions) > most.strain ||
         touches(view.probes, &ProbeRegion::finest_radius, cell, positions) ||
         view.turn(cell, 1, most.turn) > most.turn;
}

bool Adaptation::mayMerge(const View& view, const Cell& parent) const {
  const int half = parent.span() / 2;
  for (const int j : {parent.j, parent.j + half}) {
    for (const int i : {parent.i, parent.i + half}) {
      if (view.tick - born_[grid_.cell(i, j)] < options_.minimum_age) return false;
    }
  }
  const std::vector<Vec3>& positions = view.state.position;
  const Thresholds least =
      thresholdsOf(view, {options_.coarsen_below, options_.coarsen_below_strain}, parent, 2);
  return view.leaves.canMerge(parent) && strainDifference(parent, 2, view.mesh) < least.strain &&
         shortening(parent, positions) < least.strain &&
         !touches(view.probes, &ProbeRegion::finest_radius, parent, positions) &&
         view.turn(parent, 2, least.turn) < least.turn &&
         view.room(parent, 2, movedByMerge(grid_, parent, positions));
}

/// Lists the leaves that apply() will split: the marked ones, and for balance coarser neighbours.
void Adaptation::findSplits(const LeafMesh& leaves) {
  splits_.assign(grid_.cells(), 0);
  split_ = marked_;
  for (const Cell& cell : split_) splits_[grid_.cell(cell.i, cell.j)] = 1;
  for (std::size_t k = 0; k < split_.size(); ++k) {
    const Cell cell = split_[k];
    forNeighbours(cell, [&](int i, int j) {
      const Cell neighbour = leaves.leafAt(i, j);
      char& known = splits_[grid_.cell(neighbour.i, neighbour.j)];
      if (neighbour.level <= cell.level || known) return;
      known = 1;
      split_.push_back(neighbour);
    });
  }
}

/// Tells whether one of the four leaves of a parent, or a leaf beside it, will be split. Such a parent
/// does not merge: it would have to split again at once, or both would move the surface between them.
bool Adaptation::touchesSplit(const Cell& parent, const LeafMesh& leaves) const {
  if (split_.empty()) return false;
  bool touches = false;
  const auto look = [&](int i, int j) {
    const Cell leaf = leaves.leafAt(i, j);
    touches = touches || splits_[grid_.cell(leaf.i, leaf.j)];
  };
  const int half = parent.span() / 2;
  for (const int j : {parent.j, parent.j + half}) {
    for (const int i : {parent.i, parent.i + half}) {
      look(i, j);
      forNeighbours({i, j, parent.level - 1}, look);
    }
  }
  return touches;
}

void Adaptation::splitCells(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state) {
  for (const Cell& cell : marked_) leaves.split(cell, split_);
  if (split_.empty()) return;
  for (const Cell& cell : split_) {
    const int half = cell.span() / 2;
    for (const int j : {cell.j, cell.j + half}) {
      for (const int i : {cell.i, cell.i + half}) born_[grid_.cell(i, j)] = tick;
    }
  }
  transferAfterSplit(grid_, split_, crowded_, state);
  mesh.rebuild(leaves);
}

}  // namespace haptic_cloth
