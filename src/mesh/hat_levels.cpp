#include "mesh/hat_levels.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

/// Levels that leave a few hats along the longer side.
std::vector<HatLevels::Level> levelsOf(const Grid& grid) {
  constexpr int kFewest = 4;
  // A direction whose spacing is longer by this factor waits: without it cells come nearer to squares.
  constexpr double kNearlySquare = 1.41421356;
  const std::array<double, 2> spacing{grid.dx, grid.dy};
  const std::array<int, 2> cells{grid.columns - 1, grid.rows - 1};
  std::array<int, 2> span{1, 1};
  std::vector<HatLevels::Level> levels;
  while (std::max(cells[0] / span[0], cells[1] / span[1]) >= kFewest) {
    HatLevels::Level level{};
    for (std::size_t d = 0; d < 2; ++d) {
      const std::size_t other = 1 - d;
      const bool waits = span[d] * spacing[d] > kNearlySquare * span[other] * spacing[other];
      if (!waits || span[other] > cells[other]) level.spans[d] = span[d];
    }
    for (std::size_t d = 0; d < 2; ++d) span[d] += level.spans[d];
    levels.push_back(level);
  }
  return levels;
}

}  // namespace

HatLevels::HatLevels(const ActiveMesh& mesh) : grid_(mesh.grid), levels_(levelsOf(mesh.grid)) {
  const auto points_along = [](int particles, int span) {  // with one beyond the end, if need be
    return static_cast<std::size_t>((particles - 1 + span - 1) / span + 1);
  };
  number_.resize((grid_.columns + levels_.size()) * (grid_.rows + levels_.size()));
  std::size_t hats = 0, points = mesh.grid.particles() + 1;
  std::array<int, 2> span{1, 1};
  for (const Level& level : levels_) {
    for (std::size_t d = 0; d < 2; ++d) span[d] += level.spans[d];
    const std::size_t columns = points_along(grid_.columns, span[0]),
                      rows = points_along(grid_.rows, span[1]);
    hats += columns * rows;
    points += columns + rows + 1;  // points beyond the ends
  }
  place_.reserve(points);
  for (auto* list : {&remaining_, &hat_of_}) list->reserve(points);
  children_.reserve(points);
  hats_.reserve(hats);
  rebuild(mesh);
}

void HatLevels::rebuild(const ActiveMesh& mesh) {
  std::fill(number_.begin(), number_.end(), -1);
  place_.clear();
  for (auto* list : {&remaining_, &hat_of_}) list->clear();
  children_.clear();
  hats_.clear();
  for (int n = 0; n < mesh.nodes(); ++n) {
    place_.push_back({grid_.column(mesh.particle[n]), grid_.row(mesh.particle[n])});
    numberAt(place_[n].i, place_[n].j) = n;
    remaining_.push_back(n);
  }
  nowhere_ = points();
  place_.push_back({-1, -1});
  for (Level& level : levels_) {
    addChildren(level);
    addHats(level);
  }
}

/// Number of the point at a place, -1: none. In each direction a lattice has at most one point beyond the
/// cloth. That of the next lattice is the same, or farther by a spacing. So the distance to the cloth of
/// each such point has another number of bits.
int& HatLevels::numberAt(int i, int j) {
  const auto index = [](int place, int particles) -> std::size_t {
    const int beyond = place - (particles - 1);
    return beyond > 0 ? particles + std::ilogb(beyond) : place;
  };
  return number_[index(j, grid_.rows) * (grid_.columns + levels_.size()) + index(i, grid_.columns)];
}

int HatLevels::pointAt(int i, int j) {
  int& number = numberAt(i, j);
  if (number < 0) {
    number = points();
    place_.push_back({i, j});
    remaining_.push_back(number);
  }
  return number;
}

/// Adds the points between those of the next lattice as children, and keeps the others for the next
/// level.
void HatLevels::addChildren(Level& level) {
  const int count = static_cast<int>(remaining_.size());
  const auto add = [&](bool four) {
    for (int k = 0; k < count; ++k) {
      const int point = remaining_[k];
      const auto [i, j] = place_[point];
      const int di = i & level.spans[0], dj = j & level.spans[1];
      if (four ? !(di && dj) : !di == !dj) continue;
      children_.push_back({point,
                           {pointAt(i - di, j - dj), pointAt(i + di, j - dj), pointAt(i - di, j + dj),
                            pointAt(i + di, j + dj)}});
    }
    return static_cast<int>(children_.size());
  };
  level.children = static_cast<int>(children_.size());
  level.fours = add(false);
  level.children_end = add(true);
  const auto is_child = [&](int point) {
    return (place_[point].i & level.spans[0]) != 0 || (place_[point].j & level.spans[1]) != 0;
  };
  const auto end = remaining_.begin() + count;
  remaining_.erase(std::remove_if(remaining_.begin(), end, is_child), end);
}

void HatLevels::addHats(Level& level) {
  const std::array<int, 4> none{nowhere_, nowhere_, nowhere_, nowhere_};
  hat_of_.resize(points(), -1);
  level.hats = static_cast<int>(hats_.size());
  for (int k = level.children; k < level.children_end; ++k) {
    const Child& child = children_[k];
    for (int c = 0; c < 4; ++c) {
      const bool two = k < level.fours;
      if (two && (c == 1 || c == 2)) continue;
      int& hat = hat_of_[child.parents[c]];
      if (hat < 0) {
        hat = static_cast<int>(hats_.size());
        hats_.push_back({child.parents[c], none, none, 0.0});
      }
      hats_[hat].shares += two ? 0.5 : 0.25;
      auto& list = two ? hats_[hat].of_two : hats_[hat].of_four;
      *std::find(list.begin(), list.end(), nowhere_) = child.point;
    }
  }
  level.hats_end = static_cast<int>(hats_.size());
  for (int hat = level.hats; hat < level.hats_end; ++hat) hat_of_[hats_[hat].point] = -1;
}

}  // namespace haptic_cloth
