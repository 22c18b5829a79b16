/// Leaf cells: a balanced quadtree over the finest grid.
#pragma once

#include <cstdint>
#include <vector>

#include "haptic_cloth/scene.h"
#include "mesh/grid.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Balanced quadtree. Neighbouring leaves, also over corners, differ by at most one level, and
/// every pinned particle is a corner of all leaves that it touches. Both rules hold after each
/// call.
class LeafMesh {
 public:
  /// @param start_level initial level of all leaves, 0..grid.levels; leaves at pins may be finer
  LeafMesh(const Grid& grid, const std::vector<Pin>& pins, int start_level);

  const Grid& grid() const { return grid_; }
  bool pinned(int particle) const { return pinned_[particle]; }

  /// Leaf that covers finest cell (i, j).
  Cell leafAt(int i, int j) const {
    const int level = level_[grid_.cell(i, j)];
    return {i >> level << level, j >> level << level, level};
  }

  /// Splits a leaf into four, after coarser neighbours if balance requires it. Appends all split
  /// cells to `done`, in order. Does nothing if `cell` is not a leaf or is already finest.
  void split(const Cell& cell, std::vector<Cell>& done);

  /// Tells whether the four children of `parent` are leaves and may be replaced by it.
  bool canMerge(const Cell& parent) const;

  /// Replaces four leaves by their parent. @pre canMerge(parent)
  void merge(const Cell& parent) { fill(parent); }

  /// Lists all leaves by rows of their lower left corners, from bottom to top.
  void leaves(std::vector<Cell>& leaves) const;

  void serialize(Archive& archive);

 private:
  bool isLeaf(const Cell& cell) const;
  bool pinsAllow(const Cell& cell) const;
  void fill(const Cell& cell);
  bool takeOver(const std::vector<std::uint8_t>& levels);

  Grid grid_;
  std::vector<char> pinned_;         ///< one flag for each particle
  std::vector<std::uint8_t> level_;  ///< level of the leaf that covers each finest cell
};

}  // namespace haptic_cloth
