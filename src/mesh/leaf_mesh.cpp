#include "mesh/leaf_mesh.h"

#include <algorithm>

namespace haptic_cloth {

LeafMesh::LeafMesh(const Grid& grid, const std::vector<Pin>& pins, int start_level)
    : grid_(grid), pinned_(grid.particles(), 0), level_(grid.cells(), start_level) {
  for (const Pin& pin : pins) {
    for (int j = pin.j0; j <= pin.j1; ++j) {
      for (int i = pin.i0; i <= pin.i1; ++i) pinned_[grid.particle(i, j)] = 1;
    }
  }
  std::vector<Cell> done;
  for (int level = start_level; level > 0; --level) {
    const int s = 1 << level;
    for (int j = 0; j + 1 < grid.rows; j += s) {
      for (int i = 0; i + 1 < grid.columns; i += s) {
        const Cell cell{i, j, level};
        if (isLeaf(cell) && !pinsAllow(cell)) split(cell, done);
      }
    }
  }
}

bool LeafMesh::isLeaf(const Cell& cell) const {
  const Cell leaf = leafAt(cell.i, cell.j);
  return leaf.level == cell.level && leaf.i == cell.i && leaf.j == cell.j;
}

bool LeafMesh::pinsAllow(const Cell& cell) const {
  const int s = cell.span();
  for (int j = 0; j <= s; ++j) {
    for (int i = 0; i <= s; ++i) {
      const bool corner = i % s == 0 && j % s == 0;
      if (!corner && pinned_[grid_.particle(cell.i + i, cell.j + j)]) return false;
    }
  }
  return true;
}

void LeafMesh::fill(const Cell& cell) {
  const int s = cell.span();
  for (int j = cell.j; j < cell.j + s; ++j) {
    std::fill_n(level_.begin() + grid_.cell(cell.i, j), s, static_cast<std::uint8_t>(cell.level));
  }
}

void LeafMesh::split(const Cell& cell, std::vector<Cell>& done) {
  if (cell.level == 0 || !isLeaf(cell)) return;
  const int s = cell.span();
  // The eight neighbours, each found at one finest cell beside this leaf. A coarser one covers that
  // whole side.
  for (const int j : {cell.j - 1, cell.j, cell.j + s}) {
    for (const int i : {cell.i - 1, cell.i, cell.i + s}) {
      if (i < 0 || j < 0 || i > grid_.columns - 2 || j > grid_.rows - 2) continue;
      const Cell neighbour = leafAt(i, j);
      if (neighbour.level > cell.level) split(neighbour, done);
    }
  }
  const int half = s / 2;
  for (const int j : {cell.j, cell.j + half}) {
    for (const int i : {cell.i, cell.i + half}) fill({i, j, cell.level - 1});
  }
  done.push_back(cell);
}

bool LeafMesh::canMerge(const Cell& parent) const {
  const int s = parent.span(), half = s / 2, child_level = parent.level - 1;
  for (const int j : {parent.j, parent.j + half}) {
    for (const int i : {parent.i, parent.i + half}) {
      if (!isLeaf({i, j, child_level})) return false;
    }
  }
  const int i_end = std::min(parent.i + s, grid_.columns - 2), j_end = std::min(parent.j + s, grid_.rows - 2);
  for (int j = std::max(parent.j - 1, 0); j <= j_end; ++j) {
    for (int i = std::max(parent.i - 1, 0); i <= i_end; ++i) {
      const bool inside = i >= parent.i && i < parent.i + s && j >= parent.j && j < parent.j + s;
      if (!inside && level_[grid_.cell(i, j)] < child_level) return false;
    }
  }
  return pinsAllow(parent);
}

void LeafMesh::leaves(std::vector<Cell>& leaves) const {
  leaves.clear();
  for (int j = 0; j + 1 < grid_.rows; ++j) {
    for (int i = 0; i + 1 < grid_.columns;) {
      const Cell leaf = leafAt(i, j);
      if (leaf.j == j) leaves.push_back(leaf);
      i = leaf.i + leaf.span();
    }
  }
}

void LeafMesh::serialize(Archive& archive) {
  std::vector<std::uint8_t> levels = level_;
  archive.within("levels", levels, 0, grid_.levels);
  if (archive.loads()) archive.check(takeOver(levels), "levels", "must make a balanced mesh");
}

/// Splits from the coarsest mesh, which keeps all rules. @return whether the result has these
/// levels
bool LeafMesh::takeOver(const std::vector<std::uint8_t>& levels) {
  std::fill(level_.begin(), level_.end(), static_cast<std::uint8_t>(grid_.levels));
  std::vector<Cell> done;
  for (int level = grid_.levels; level > 0; --level) {
    const int s = 1 << level;
    for (int j = 0; j + 1 < grid_.rows; j += s) {
      for (int i = 0; i + 1 < grid_.columns; i += s) {
        const Cell cell{i, j, level};
        if (levels[grid_.cell(i, j)] < level || !pinsAllow(cell)) split(cell, done);
      }
    }
  }
  return level_ == levels;
}

}  // namespace haptic_cloth
