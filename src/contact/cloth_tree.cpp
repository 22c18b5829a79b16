#include "contact/cloth_tree.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

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
  places_.reserve(grid.particles());
  node_boxes_.reserve(grid.particles());
  node_motions_.reserve(grid.particles());
  tangents_.reserve(size);
  tangents_after_.reserve(size);
  smooth_.reserve(4 * size);
  rough_.reserve(size);
  squares_.resize(size);
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
void ClothTree::unite(const ActiveMesh& mesh, std::vector<Value>& values) const {
  for (std::size_t p = mesh.patches.size(); p < parts_.size(); ++p) {
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
  unite(mesh, boxes_);
  unite(mesh, motions_);
  fitTangents(mesh, tangents_);
  forgetSmooth();
}

void ClothTree::fitNodes(const Field& nodes, const Field& motion, const std::vector<double>& margins) {
  placeNodes(nodes);
  node_motions_.resize(nodes.size());
  for (int n = 0; n < nodes.size(); ++n) node_motions_[n] = toFloats(motion[n]);
  node_boxes_.resize(nodes.size());
  for (int n = 0; n < nodes.size(); ++n) {
    const float size = (places_[n].cwiseAbs() + node_motions_[n].cwiseAbs()).maxCoeff();
    const Float4 margin =
        Float4::Constant((1.0f + kRounding) * static_cast<float>(margins[n]) + kRounding * size);
    node_boxes_[n] = {places_[n] - margin, places_[n] + margin};
  }
}

void ClothTree::placeNodes(const Field& nodes) {
  places_.resize(nodes.size());
  const Vec3 origin = nodes[0];
  for (int n = 0; n < nodes.size(); ++n) places_[n] = toFloats(nodes[n] - origin);
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

inline ClothTree::Range ClothTree::Range::of(const Float4& one, const Float4& other) {
  const auto between = [](const Float4& a, const Float4& b) { return Box{a.cwiseMin(b), a.cwiseMax(b)}; };
  const Float4 p(one[1], one[2], one[0], 0.0f), q(other[1], other[2], other[0], 0.0f);
  return {between(one, other), between(one + p, other + q), between(one - p, other - q)};
}

void ClothTree::fitTangents(const ActiveMesh& mesh, std::vector<Tangents>& tangents) const {
  tangents.resize(parts_.size());
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const Patch& patch = mesh.patches[k];
    const float per_warp = static_cast<float>(1.0 / (patch.cell.span() * grid_.dx)),
                per_weft = static_cast<float>(1.0 / (patch.cell.span() * grid_.dy));
    const Float4 x[] = {places_[patch.nodes[0]], places_[patch.nodes[1]], places_[patch.nodes[2]],
                        places_[patch.nodes[3]]};
    tangents[k] = {Range::of(per_warp * (x[1] - x[0]), per_warp * (x[3] - x[2])),
                   Range::of(per_weft * (x[2] - x[0]), per_weft * (x[3] - x[1]))};
  }
  unite(mesh, tangents);
}

/// Bounds of the components along an axis, as a sum of three of the directions with weights >= 0.
inline ClothTree::Range::Ends ClothTree::Range::along(const Float4& axis) const {
  const Float4 size = axis.cwiseAbs();
  Ends ends{0.0f, 0.0f};
  const auto add = [&ends](float weight, const Box& box, int k, bool turned) {
    ends.low += weight * (turned ? -box.high[k] : box.low[k]);
    ends.high += weight * (turned ? -box.low[k] : box.high[k]);
  };
  // The diagonal between component k and the next, in the sense of the axis.
  const auto addDiagonal = [&](float weight, int k) {
    const float next = axis[(k + 1) % 3];
    add(weight, (axis[k] < 0.0f) == (next < 0.0f) ? sums : differences, k, axis[k] < 0.0f);
  };
  const float half = 0.5f * (size[0] + size[1] + size[2]);
  int most = 0;
  size.head<3>().maxCoeff(&most);
  const int next = (most + 1) % 3, last = (most + 2) % 3;
  if (size[most] >= half) {
    add(2.0f * (size[most] - half), axes, most, axis[most] < 0.0f);
    addDiagonal(size[next], most);
    addDiagonal(size[last], last);
  } else {
    for (int k = 0; k < 3; ++k) addDiagonal(half - size[(k + 2) % 3], k);
  }
  return ends;
}

/// Largest |t_1 · e_2 + t_2 · e_1| over the ranges of the tangents.
inline float ClothTree::largestMixed(const Tangents& t, const Axes& axes) {
  const Range::Ends one = t.warp.along(axes.second), other = t.weft.along(axes.first);
  return std::max(std::abs(one.low + other.low), std::abs(one.high + other.high));
}

/// Tells whether λ is at least `least` over the ranges of the tangents.
inline bool ClothTree::isSmooth(const Tangents& t, const Axes& axes, float least) {
  const float a = t.warp.along(axes.first).low - least, b = t.weft.along(axes.second).low - least;
  if (!(a >= 0.0f) || !(b >= 0.0f)) return false;
  const float mixed = largestMixed(t, axes);
  return 4.0f * a * b >= mixed * mixed;
}

/// The largest `least` with which they are smooth: the smaller root of the condition there.
inline float ClothTree::lambda(const Tangents& t, const Axes& axes) {
  const float a = t.warp.along(axes.first).low, b = t.weft.along(axes.second).low;
  return 0.5f * (a + b - std::hypot(a - b, largestMixed(t, axes)));
}

/// Tells whether parts that fill a rectangle are smooth together, and keeps it if so.
bool ClothTree::isSmooth(const std::array<int, 4>& parts, int count) {
  Axes axes;
  if (!findAxes(parts, count, tangentsOf(parts, count), axes)) return false;
  smooth_.push_back({parts, count, axes});
  return true;
}

ClothTree::Tangents ClothTree::tangentsOf(const std::array<int, 4>& parts, int count) const {
  Tangents tangents = tangents_[parts[0]];
  for (int k = 1; k < count; ++k) tangents.add(tangents_[parts[k]]);
  return tangents;
}

/// Finds orthonormal axes near the mean tangents of parts. @return whether the parts are smooth by them
bool ClothTree::findAxes(const std::array<int, 4>& parts, int count, const Tangents& tangents,
                         Axes& axes) const {
  const auto isRough = [this](int part) { return rough_[part] != 0; };
  if (std::any_of(parts.begin(), parts.begin() + count, isRough)) return false;
  axes.first = tangents.warp.middle().normalized();
  if (!(tangents.warp.along(axes.first).low >= least_)) return false;
  const Float4 weft = tangents.weft.middle();
  axes.second = (weft - axes.first.dot(weft) * axes.first).normalized();
  return isSmooth(tangents, axes, least_);
}

/// Let no tangent change by more than δ. Then the middle of a range changes by up to √3 δ. What the axes
/// are normalised from is at least 0.5 long, and tangents are at most 1.2. So the first axis changes by up
/// to 2 √3 δ, the second by 2 (√3 + 2 · 1.2 · 2 √3) δ = 20 δ, (t_i · e_j) by 25 δ and λ by 50 δ. Parts with
/// longer tangents keep their distances too, since by the old axes λ falls by √2 δ, but a new forNear()
/// might visit them.
bool ClothTree::keepsSmooth(const ActiveMesh& mesh, const Field& start, const Field& nodes,
                            double spare) const {
  return 50.0 * largestTurn(mesh, start, nodes) <= spare;
}

double ClothTree::spareAt(const ActiveMesh& mesh, const Field& nodes) {
  placeNodes(nodes);
  fitTangents(mesh, tangents_);
  float least = 1.0f;
  for (const Smooth& smooth : smooth_) {
    const Tangents tangents = tangentsOf(smooth.parts, smooth.count);
    Axes axes;
    if (!findAxes(smooth.parts, smooth.count, tangents, axes)) return -1.0;
    least = std::min(least, lambda(tangents, axes));
  }
  return std::max(0.0f, (1.0f - kRounding) * least - kSmooth);
}

/// Tells whether two parts beside each other, or one part, lie in a smooth rectangle of up to 2 × 2 parts.
bool ClothTree::isSmoothTogether(int a, int b) {
  if (a == b) return isSmooth({a}, 1);
  const Part &one = parts_[a], &other = parts_[b];
  const bool in_row = one.j == other.j, in_column = one.i == other.i;
  int i = std::min(one.i, other.i), j = std::min(one.j, other.j);
  if (!in_row && !in_column) return isSmoothSquare(one.level, i, j);
  // Across the border of two parents their square is needed for its diagonals, too.
  if ((in_row ? i : j) % 2 == 1) {
    int& along = in_row ? j : i;  // the border
    along -= along % 2;
    if (isInside(one.level, i + 1, j + 1) && isSmoothSquare(one.level, i, j)) return true;
  }
  return isSmooth({a, b}, 2);
}

bool ClothTree::isInside(int level, int i, int j) const {
  return i < sizeAt(grid_.columns - 1, level) && j < sizeAt(grid_.rows - 1, level);
}

/// Tells whether 2 × 2 parts are smooth together: that at (i, j) and its neighbours.
bool ClothTree::isSmoothSquare(int level, int i, int j) {
  Square& known = squares_[at(level, i, j)];
  if (known != Square::Unknown) return known == Square::Smooth;
  std::array<int, 4> parts{};
  for (int k = 0; k < 4; ++k) {
    const int column = i + k % 2, row = j + k / 2;
    // A coarser leaf around this place holds its tangents.
    int place = index_[at(level, column, row)];
    for (int above = 1; place < 0; ++above) place = index_[at(level + above, column >> above, row >> above)];
    parts[k] = place;
  }
  const bool smooth = isSmooth(parts, 4);
  known = smooth ? Square::Smooth : Square::Rough;
  return smooth;
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
bool ClothTree::turnsLittle(const ActiveMesh& mesh, const Field& start, const Field& end) const {
  return largestTurn(mesh, start, end) < (kSmooth - kStillSmooth) / std::sqrt(2.0);
}

bool ClothTree::staysSmooth(const ActiveMesh& mesh, const Field& end) {
  placeNodes(end);
  fitTangents(mesh, tangents_after_);
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
