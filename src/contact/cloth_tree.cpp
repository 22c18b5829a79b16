#include "contact/cloth_tree.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

int sizeAt(int cells, int level) { return (cells + (1 << level) - 1) >> level; }

Eigen::Vector4f toFloats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}

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
  node_boxes_.reserve(grid.particles());
  node_motions_.reserve(grid.particles());
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
  fitNodes(nodes, motion, margins);
  boxes_.resize(parts_.size());
  motions_.resize(parts_.size());
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const auto& n = mesh.patches[k].nodes;
    boxes_[k] = node_boxes_[n[0]];
    motions_[k] = {node_motions_[n[0]], node_motions_[n[0]]};
    for (int c = 1; c < 4; ++c) {
      boxes_[k].add(node_boxes_[n[c]]);
      motions_[k].add({node_motions_[n[c]], node_motions_[n[c]]});
    }
  }
  unite(boxes_);
  unite(motions_);
  fitTangents(mesh, nodes, tangents_);
}

void ClothTree::fitNodes(const Field& nodes, const Field& motion, const std::vector<double>& margins) {
  constexpr double kRounding = 1e-6;  // of a few sums of floats, relative
  node_boxes_.resize(nodes.size());
  node_motions_.resize(nodes.size());
  const Vec3 origin = nodes[0];
  for (int n = 0; n < nodes.size(); ++n) {
    const Vec3 x = nodes[n] - origin, moves = motion[n];
    const double size = x.cwiseAbs().maxCoeff() + moves.cwiseAbs().maxCoeff() + margins[n];
    const Vec3 margin = Vec3::Constant(margins[n] + kRounding * size);
    node_boxes_[n] = {toFloats(x - margin), toFloats(x + margin)};
    node_motions_[n] = toFloats(moves);
  }
}

/// Tells whether the boxes of two parts come within `margin` of each other somewhere on the way of
/// their relative motion [m].
bool ClothTree::mayMeet(int a, int b, float margin) const {
  const Box &one = boxes_[a], &other = boxes_[b];
  const Float4 low = (motions_[a].low - motions_[b].high).cwiseMin(Float4::Zero()),
               high = (motions_[a].high - motions_[b].low).cwiseMax(Float4::Zero());
  const Float4 gaps = (one.low + low - other.high).cwiseMax(other.low - one.high - high);
  return gaps.maxCoeff() <= margin;
}

void ClothTree::fitTangents(const ActiveMesh& mesh, const Field& nodes,
                            std::vector<Tangents>& tangents) const {
  tangents.resize(parts_.size());
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const Patch& patch = mesh.patches[k];
    const auto x = corners(patch, nodes);
    const double per_warp = 1.0 / (patch.cell.span() * grid_.dx),
                 per_weft = 1.0 / (patch.cell.span() * grid_.dy);
    const auto between = [](const Vec3& from, const Vec3& to, double per_length) {
      const Float4 tangent = toFloats(per_length * (to - from));
      return Box{tangent, tangent};
    };
    tangents[k] = {between(x[0], x[1], per_warp), between(x[0], x[2], per_weft)};
    tangents[k].add({between(x[2], x[3], per_warp), between(x[1], x[3], per_weft)});
  }
  unite(tangents);
}

/// Orthonormal axes near the mean tangents.
ClothTree::Axes ClothTree::axesOf(const Tangents& tangents) {
  const Float4 warp = (tangents.warp.low + tangents.warp.high).normalized(),
               weft = tangents.weft.low + tangents.weft.high;
  return {warp, (weft - warp.dot(weft) * warp).normalized()};
}

/// Tells whether λ is at least `least` over the ranges of the tangents.
bool ClothTree::isSmooth(const Tangents& t, const Axes& axes, float least) {
  const Float4 first = axes.first.cwiseAbs(), second = axes.second.cwiseAbs();
  const Float4 warp = 0.5f * (t.warp.low + t.warp.high), warp_half = 0.5f * (t.warp.high - t.warp.low),
               weft = 0.5f * (t.weft.low + t.weft.high), weft_half = 0.5f * (t.weft.high - t.weft.low);
  const float a = warp.dot(axes.first) - warp_half.dot(first) - least,
              b = weft.dot(axes.second) - weft_half.dot(second) - least;
  if (!(a >= 0.0f) || !(b >= 0.0f)) return false;
  const float mixed =
      std::abs(warp.dot(axes.second) + weft.dot(axes.first)) + warp_half.dot(second) + weft_half.dot(first);
  return 4.0f * a * b >= mixed * mixed;
}

/// Tells whether parts that fill a rectangle are smooth together.
bool ClothTree::isSmooth(const std::array<int, 4>& parts, int count) {
  Tangents tangents = tangents_[parts[0]];
  bool rough = rough_[parts[0]];
  for (int k = 1; k < count; ++k) {
    tangents.add(tangents_[parts[k]]);
    rough = rough || rough_[parts[k]];
  }
  if (rough) return false;
  const Axes axes = axesOf(tangents);
  if (!isSmooth(tangents, axes, kSmooth)) return false;
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

/// Largest change of a tangent [-].
double ClothTree::largestTurn(const ActiveMesh& mesh, const Field& start, const Field& end) const {
  double warp = 0.0, weft = 0.0;  // squared, for a cell of the finest spacing [m²]
  for (const Patch& patch : mesh.patches) {
    const auto moved = [&](int corner) {
      return Vec3(end[patch.nodes[corner]] - start[patch.nodes[corner]]);
    };
    const Vec3 d[] = {moved(0), moved(1), moved(2), moved(3)};
    const double scale = 1.0 / (patch.cell.span() * patch.cell.span());
    warp = std::max(warp, scale * std::max((d[1] - d[0]).squaredNorm(), (d[3] - d[2]).squaredNorm()));
    weft = std::max(weft, scale * std::max((d[2] - d[0]).squaredNorm(), (d[3] - d[1]).squaredNorm()));
  }
  return std::max(std::sqrt(warp) / grid_.dx, std::sqrt(weft) / grid_.dy);
}

/// If no tangent changes by more than δ, no λ falls by more than √2 δ, the norm of the change of (t_i · e_j).
bool ClothTree::staysSmooth(const ActiveMesh& mesh, const Field& start, const Field& end) {
  if (largestTurn(mesh, start, end) < (kSmooth - kStillSmooth) / std::sqrt(2.0)) return true;
  fitTangents(mesh, end, tangents_after_);
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
