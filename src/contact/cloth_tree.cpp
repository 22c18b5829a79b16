#include "contact/cloth_tree.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

int sizeAt(int cells, int level) { return (cells + (1 << level) - 1) >> level; }

ClothTree::Box around(const Vec3& a, const Vec3& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }

}  // namespace

ClothTree::ClothTree(const Grid& grid)
    : grid_(grid), nearest_(grid.dx * grid.dy / std::hypot(grid.dx, grid.dy)), levels_(0) {
  const int columns = grid.columns - 1, rows = grid.rows - 1;
  while ((1 << levels_) < std::max(columns, rows)) ++levels_;
  int size = 0;
  for (int level = 0; level <= levels_; ++level) {
    level_offset_.push_back(size);
    size += sizeAt(columns, level) * sizeAt(rows, level);
  }
  index_.resize(size);
  parts_.reserve(size);
  for (auto* list : {&boxes_, &motions_}) list->reserve(size);
  tangents_.reserve(size);
  tangents_after_.reserve(size);
  smooth_.reserve(4 * size);
  rough_.reserve(size);
}

int ClothTree::at(int level, int i, int j) const {
  return level_offset_[level] + j * sizeAt(grid_.columns - 1, level) + i;
}

void ClothTree::rebuild(const ActiveMesh& mesh) {
  std::fill(index_.begin(), index_.end(), -1);
  parts_.clear();
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const Cell& cell = mesh.patches[k].cell;
    parts_.push_back({cell.level, cell.i >> cell.level, cell.j >> cell.level, k, {-1, -1, -1, -1}});
    index_[at(parts_[k].level, parts_[k].i, parts_[k].j)] = k;
  }
  for (int level = 1; level <= levels_; ++level) {
    for (int j = 0; j < sizeAt(grid_.rows - 1, level); ++j) {
      for (int i = 0; i < sizeAt(grid_.columns - 1, level); ++i) {
        Part part{level, i, j, -1, {-1, -1, -1, -1}};
        bool any = false;
        for (int k = 0; k < 4; ++k) {
          const int ci = 2 * i + k % 2, cj = 2 * j + k / 2;
          if (ci >= sizeAt(grid_.columns - 1, level - 1) || cj >= sizeAt(grid_.rows - 1, level - 1)) continue;
          part.children[k] = index_[at(level - 1, ci, cj)];
          any = any || part.children[k] >= 0;
        }
        if (!any) continue;
        index_[at(level, i, j)] = static_cast<int>(parts_.size());
        parts_.push_back(part);
      }
    }
  }
  forgetRough();
  top_ = index_[at(levels_, 0, 0)];
}

/// Unites the values of the children: of all parts above the leaves.
template <class Value>
void ClothTree::unite(std::vector<Value>& values) const {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (parts_[p].patch >= 0) continue;
    bool first = true;
    for (const int child : parts_[p].children) {
      if (child < 0) continue;
      if (first) values[p] = values[child];
      values[p].add(values[child]);
      first = false;
    }
  }
}

void ClothTree::fit(const ActiveMesh& mesh, const Field& nodes, const Field& motion,
                    const std::vector<double>& margins) {
  boxes_.resize(parts_.size());
  motions_.resize(parts_.size());
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    for (int c = 0; c < 4; ++c) {
      const int n = mesh.patches[k].nodes[c];
      const Vec3 margin = Vec3::Constant(margins[n]), x = nodes[n], moves = motion[n];
      const Box box{x - margin, x + margin}, way{moves, moves};
      if (c == 0) {
        boxes_[k] = box;
        motions_[k] = way;
      } else {
        boxes_[k].add(box);
        motions_[k].add(way);
      }
    }
  }
  unite(boxes_);
  unite(motions_);
  fitTangents(mesh, nodes, tangents_);
}

/// Tells whether the boxes of two parts come within `margin` of each other somewhere on the way of
/// their relative motion [m].
bool ClothTree::mayMeet(int a, int b, double margin) const {
  const Vec3 low = motions_[a].low - motions_[b].high, high = motions_[a].high - motions_[b].low;
  const Box &one = boxes_[a], &other = boxes_[b];
  return ((one.low + low.cwiseMin(0.0)).array() <= other.high.array() + margin).all() &&
         (other.low.array() <= (one.high + high.cwiseMax(0.0)).array() + margin).all();
}

void ClothTree::fitTangents(const ActiveMesh& mesh, const Field& nodes,
                            std::vector<Tangents>& tangents) const {
  tangents.resize(parts_.size());
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const Patch& patch = mesh.patches[k];
    const auto x = corners(patch, nodes);
    const double du = patch.cell.span() * grid_.dx, dv = patch.cell.span() * grid_.dy;
    tangents[k] = {around((x[1] - x[0]) / du, (x[3] - x[2]) / du),
                   around((x[2] - x[0]) / dv, (x[3] - x[1]) / dv)};
  }
  unite(tangents);
}

/// Orthonormal axes near the mean tangents.
ClothTree::Axes ClothTree::axesOf(const Tangents& tangents) {
  const Vec3 warp = (tangents.warp.low + tangents.warp.high).normalized(),
             weft = tangents.weft.low + tangents.weft.high;
  return {warp, (weft - warp.dot(weft) * warp).normalized()};
}

/// Tells whether λ is at least `least` over the ranges of the tangents.
bool ClothTree::isSmooth(const Tangents& t, const Axes& axes, double least) {
  const auto middle = [](const Box& box) { return Vec3(0.5 * (box.low + box.high)); };
  const auto half = [](const Box& box) { return Vec3(0.5 * (box.high - box.low)); };
  const Vec3 first = axes.first.cwiseAbs(), second = axes.second.cwiseAbs();
  const double a = middle(t.warp).dot(axes.first) - half(t.warp).dot(first) - least;
  const double b = middle(t.weft).dot(axes.second) - half(t.weft).dot(second) - least;
  if (!(a >= 0.0) || !(b >= 0.0)) return false;
  const double mixed = std::abs(middle(t.warp).dot(axes.second) + middle(t.weft).dot(axes.first)) +
                       half(t.warp).dot(second) + half(t.weft).dot(first);
  return 4.0 * a * b >= mixed * mixed;
}

/// Tells whether parts that fill a rectangle are smooth together.
bool ClothTree::isSmooth(const std::array<int, 4>& parts, int count) {
  Tangents tangents = tangents_[parts[0]];
  bool rough = rough_[parts[0]];
  for (int k = 1; k < count; ++k) {
    tangents.add(tangents_[parts[k]]);
    rough = rough || rough_[parts[k]];
  }
  const Axes axes = axesOf(tangents);
  if (rough || !isSmooth(tangents, axes, kSmooth)) return false;
  smooth_.push_back({parts, count, axes});
  return true;
}

/// Tells whether two parts beside each other lie in a smooth rectangle of 2 × 1, 1 × 2 or 2 × 2 parts.
bool ClothTree::isSmoothTogether(int a, int b) {
  const Part &one = parts_[a], &other = parts_[b];
  std::array<int, 4> parts{};
  int count = 0;
  for (int j = std::min(one.j, other.j); j <= std::max(one.j, other.j); ++j) {
    for (int i = std::min(one.i, other.i); i <= std::max(one.i, other.i); ++i) {
      // A coarser leaf around this place holds its tangents.
      int level = one.level, place = index_[at(level, i, j)];
      for (int k = 1; place < 0; ++k) place = index_[at(level + k, i >> k, j >> k)];
      parts[count++] = place;
    }
  }
  return isSmooth(parts, count);
}

bool ClothTree::staysSmooth(const ActiveMesh& mesh, const Field& nodes) {
  fitTangents(mesh, nodes, tangents_after_);
  bool all = true;
  for (const Smooth& smooth : smooth_) {
    Tangents tangents = tangents_after_[smooth.parts[0]];
    for (int k = 1; k < smooth.count; ++k) tangents.add(tangents_after_[smooth.parts[k]]);
    if (isSmooth(tangents, smooth.axes, kStillSmooth)) continue;
    for (int k = 0; k < smooth.count; ++k) rough_[smooth.parts[k]] = 1;
    all = false;
  }
  return all;
}

}  // namespace haptic_cloth
