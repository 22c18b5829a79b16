#include "mesh/hat_levels.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

/// As many as leave a few hats along the longer side.
int levelsOf(const Grid& grid) {
  constexpr int kFewest = 4;
  int levels = 0;
  while ((std::max(grid.columns, grid.rows) - 1) >> levels >= kFewest) ++levels;
  return levels;
}

}  // namespace

HatLevels::HatLevels(const ActiveMesh& mesh) : levels_(levelsOf(mesh.grid)) {
  const auto last = [&](int particles, std::size_t level) {  // on the level's lattice
    return (particles - 1 + (1 << level) - 1) >> level;
  };
  columns_ = (last(mesh.grid.columns, levels_.size()) << levels_.size()) + 1;
  number_.resize(columns_ * ((last(mesh.grid.rows, levels_.size()) << levels_.size()) + 1));
  std::size_t hats = 0, points = mesh.grid.particles();
  for (std::size_t level = 1; level <= levels_.size(); ++level) {
    const std::size_t columns = last(mesh.grid.columns, level) + 1, rows = last(mesh.grid.rows, level) + 1;
    hats += columns * rows;
    points += columns + rows + 1;  // past the ends
  }
  for (auto* list : {&place_, &remaining_, &hat_of_}) list->reserve(points);
  children_.reserve(points);
  hats_.reserve(hats);
  rows_.reserve(hats + 1);
  entries_.reserve(4 * points);
  rebuild(mesh);
}

void HatLevels::rebuild(const ActiveMesh& mesh) {
  std::fill(number_.begin(), number_.end(), -1);
  for (auto* list : {&place_, &remaining_, &hat_of_, &hats_, &rows_, &entries_}) list->clear();
  children_.clear();
  const Grid& grid = mesh.grid;
  for (int n = 0; n < mesh.nodes(); ++n) {
    place_.push_back(grid.row(mesh.particle[n]) * columns_ + grid.column(mesh.particle[n]));
    number_[place_[n]] = n;
    remaining_.push_back(n);
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    levels_[l].children = static_cast<int>(children_.size());
    addChildren(1 << l);
    levels_[l].children_end = static_cast<int>(children_.size());
    addHats(levels_[l]);
  }
  rows_.push_back(static_cast<int>(entries_.size()));
}

int HatLevels::pointAt(int i, int j) {
  int& number = number_[j * columns_ + i];
  if (number < 0) {
    number = points();
    place_.push_back(j * columns_ + i);
    remaining_.push_back(number);
  }
  return number;
}

/// Of the lattice with that span between points; keeps those that remain on the next one.
void HatLevels::addChildren(int span) {
  const int count = static_cast<int>(remaining_.size());
  int kept = 0;
  for (int k = 0; k < count; ++k) {
    const int point = remaining_[k], i = place_[point] % columns_, j = place_[point] / columns_;
    const int di = i & span, dj = j & span;
    if (di == 0 && dj == 0) {
      remaining_[kept++] = point;
      continue;
    }
    children_.push_back({point,
                         {pointAt(i - di, j - dj), pointAt(i + di, j - dj), pointAt(i - di, j + dj),
                          pointAt(i + di, j + dj)}});
  }
  remaining_.erase(remaining_.begin() + kept, remaining_.begin() + count);
}

/// Counts each hat's children, then lists them, the last first.
void HatLevels::addHats(Level& level) {
  hat_of_.resize(points(), -1);
  level.hats = static_cast<int>(hats_.size());
  for (int k = level.children; k < level.children_end; ++k) {
    for (const int parent : children_[k].parents) {
      if (hat_of_[parent] < 0) {
        hat_of_[parent] = static_cast<int>(hats_.size());
        hats_.push_back(parent);
        rows_.push_back(0);
      }
      ++rows_[hat_of_[parent]];
    }
  }
  level.hats_end = static_cast<int>(hats_.size());
  int end = static_cast<int>(entries_.size());
  for (int hat = level.hats; hat < level.hats_end; ++hat) rows_[hat] = end += rows_[hat];
  entries_.resize(end);
  for (int k = level.children_end - 1; k >= level.children; --k) {
    for (const int parent : children_[k].parents) entries_[--rows_[hat_of_[parent]]] = children_[k].point;
  }
  for (int hat = level.hats; hat < level.hats_end; ++hat) hat_of_[hats_[hat]] = -1;
}

}  // namespace haptic_cloth
