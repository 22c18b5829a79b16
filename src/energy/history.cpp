#include "energy/history.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

enum Side { kBelow, kAbove, kLeft, kRight };

}  // namespace

ForceHistory::ForceHistory(const Grid& grid)
    : grid_(grid),
      sides_(grid.cells()),
      shear_(grid.cells()),
      bending_(grid.particles()),
      used_(grid.particles() / kPage + 1, 0) {}

void ForceHistory::clearBending() {
  for (int page = 0; page < static_cast<int>(used_.size()); ++page) {
    if (!used_[page]) continue;
    const int begin = kPage * page, end = std::min(begin + kPage, grid_.particles());
    std::fill(bending_.data() + begin, bending_.data() + end, Bending{});
    used_[page] = 0;
  }
}

/// Children of a cell: lower left, lower right, upper left, upper right.
std::array<Cell, 4> ForceHistory::children(const Cell& parent) const {
  const int half = parent.span() / 2, level = parent.level - 1;
  return {Cell{parent.i, parent.j, level}, Cell{parent.i + half, parent.j, level},
          Cell{parent.i, parent.j + half, level}, Cell{parent.i + half, parent.j + half, level}};
}

void ForceHistory::merge(const Cell& parent) {
  const auto c = children(parent);
  // A coarse side takes over the strips of its two fine sides, and half of the strip of the middle
  // thread.
  Sides merged{};
  for (const int column : {0, 1}) {
    const Sides &low = sides(c[column]), &high = sides(c[2 + column]);
    const double middle = 0.5 * (low[kAbove] + high[kBelow]);
    merged[kBelow] += 0.25 * (low[kBelow] + middle);
    merged[kAbove] += 0.25 * (high[kAbove] + middle);
  }
  for (const int row : {0, 2}) {
    const Sides &left = sides(c[row]), &right = sides(c[row + 1]);
    const double middle = 0.5 * (left[kRight] + right[kLeft]);
    merged[kLeft] += 0.25 * (left[kLeft] + middle);
    merged[kRight] += 0.25 * (right[kRight] + middle);
  }
  const double mean = 0.25 * (shear(c[0]) + shear(c[1]) + shear(c[2]) + shear(c[3]));
  sides(parent) = merged;
  shear(parent) = mean;
  mergeBending(parent);
}

/// Merges moments. A coarse triple at a corner takes about half of the moment in the middle of the
/// side, in the quarter of its surroundings that this cell covers.
void ForceHistory::mergeBending(const Cell& parent) {
  constexpr double kShare = 0.25 * 0.5;
  const auto p = parent.corners(grid_);
  const auto average = [this](int direction, int a, int b) {
    const Bending& middle = bending((a + b) / 2);
    for (Bending* end : {&bending(a), &bending(b)}) {
      for (const int k : {direction, 2 + direction}) (*end)[k] += kShare * (middle[k] - (*end)[k]);
    }
  };
  average(kWarp, p[0], p[1]);
  average(kWarp, p[2], p[3]);
  average(kWeft, p[0], p[2]);
  average(kWeft, p[1], p[3]);
}

void ForceHistory::split(const Cell& parent) {
  const Sides coarse = sides(parent);
  const double mean_warp = 0.5 * (coarse[kBelow] + coarse[kAbove]),
               mean_weft = 0.5 * (coarse[kLeft] + coarse[kRight]), force = shear(parent);
  const auto c = children(parent);
  for (int k = 0; k < 4; ++k) {
    const bool right = k % 2 == 1, upper = k / 2 == 1;
    sides(c[k]) = {upper ? mean_warp : coarse[kBelow], upper ? coarse[kAbove] : mean_warp,
                   right ? mean_weft : coarse[kLeft], right ? coarse[kRight] : mean_weft};
    shear(c[k]) = force;
  }
  const auto p = parent.corners(grid_);
  for (std::size_t k = 0; k < Bending().size(); ++k) {
    const auto m = [this, k](int particle) -> double& { return bending(particle)[k]; };
    for (const auto& [a, b] : {std::pair(p[0], p[1]), {p[2], p[3]}, {p[0], p[2]}, {p[1], p[3]}}) {
      m((a + b) / 2) = 0.5 * (m(a) + m(b));
    }
    m((p[0] + p[3]) / 2) = 0.25 * (m(p[0]) + m(p[1]) + m(p[2]) + m(p[3]));
  }
}

}  // namespace haptic_cloth
