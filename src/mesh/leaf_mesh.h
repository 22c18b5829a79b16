/// The leaf cells: a balanced quadtree over the finest grid.
#pragma once

#include <cstdint>
#include <vector>

#include "haptic_cloth/scene.h"
#include "mesh/grid.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Leaves differ by at most one level from every neighbour, corner neighbours included, and every pinned
/// particle is a corner of all leaves it touches. Both hold after each call.
class LeafMesh {
 public:
  /// @param start_level level of all leaves at first (finer where pins ask for it), 0..grid.levels
  LeafMesh(const Grid& grid, const std::vector<ParticleRange>& pins, int start_level);

  const Grid& grid() const { return grid_; }
  bool pinned(int particle) const { return pinned_[particle]; }

  /// Leaf that covers finest cell (i, j).
  Cell leafAt(int i, int j) const {
    const int level = level_[grid_.cell(i, j)];
    return {i >> level << level, j >> level << level, level};
  }

  /// Splits a leaf in four, and coarser neighbours first where balance asks for it. Appends what was split to
  /// `done`, in that order; does nothing if `cell` is no leaf or already finest.
  void split(const Cell& cell, std::vector<Cell>& done);

  /// True where `parent`'s four children are leaves and may be replaced by it.
  bool canMerge(const Cell& parent) const;

  /// Replaces four leaves by their parent. @pre canMerge(parent)
  void merge(const Cell& parent) { fill(parent); }

  /// All leaves, rows of their lower left corners from bottom to top.
  void leaves(std::vector<Cell>& leaves) const;

  void serialize(Archive& archive);

 private:
  bool isLeaf(const Cell& cell) const;
  bool pinsAllow(const Cell& cell) const;
  void fill(const Cell& cell);
  bool takeOver(const std::vector<std::uint8_t>& levels);

  Grid grid_;
  std::vector<char> pinned_;         ///< a particle each
  std::vector<std::uint8_t> level_;  ///< level of the covering leaf, a finest cell each
};

}  // namespace haptic_cloth
