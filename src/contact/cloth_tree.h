/// Tree of boxes and tangents over the leaves of the mesh: which parts of the cloth may meet.
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// The quadtree of the mesh as a hierarchy of bounding volumes. Each part of the tree knows a box
/// around it and the range of its tangents, the derivatives of position by warp and weft.
///
/// Smooth parts cannot meet themselves. Let e₁, e₂ be orthonormal and Δ = (Δu, Δv) the distance of two
/// points of a rectangle in the flat cloth. Their distance x(q) - x(p) is the mean of t_u Δu + t_v Δv
/// along the line between them, so in the direction e₁ Δu + e₂ Δv it is at least λ |Δ|², where λ is
/// the smallest eigenvalue of the symmetric part of (t_i · e_j) over the rectangle. If λ > 0, no two
/// points of the rectangle touch [after Noshiro and Warschawski's condition for univalence]. This
/// takes the place of normal cones, whose test of outlines is usually left out.
///
/// Everything is kept in vectors of four floats, whose last entry is zero, but for the margins of boxes.
/// Boxes are wider by more than the rounding. Tangents are not: their rounding is 1e-7 times the cells
/// between a part and the first node, which is far below λ.
class ClothTree {
 public:
  explicit ClothTree(const Grid& grid);

  /// Adapts to a new mesh.
  void rebuild(const ActiveMesh& mesh);

  /// Fits boxes and tangents to positions [m].
  /// @param motion expected displacement of each node [m]
  /// @param margins of the boxes at each node [m]
  void fit(const ActiveMesh& mesh, const Field& nodes, const Field& motion,
           const std::vector<double>& margins);

  /// Bound of the expected motion of two patches relative to each other [m].
  double largestMotion(int a, int b) const {
    const Box &one = motions_[a], &other = motions_[b];
    const Float4 most = (one.high - other.low).cwiseMax(other.high - one.low);
    return most.norm() + kRounding * (sizeOf(one) + sizeOf(other));
  }

  /// Calls visit(a, b) for all pairs of patches, a = b included, whose boxes overlap somewhere on the
  /// way of the expected motion, unless they lie in one smooth rectangle.
  /// @param spare what λ of a smooth rectangle must have beyond the least [-]
  template <class Visit>
  void forNear(double spare, const Visit& visit) {
    least_ = kSmooth + static_cast<float>(spare);
    forgetSmooth();
    visitSelf(top_, visit);
    least_ = kSmooth;
  }

  /// Tells whether forNear() without spare is sure to find rectangles smooth at some positions, because no
  /// tangent has turned much. @param start,spare positions at which they had this spare [m, -]
  bool keepsSmooth(const ActiveMesh& mesh, const Field& start, const Field& nodes, double spare) const;

  /// Spare of the rectangles of the last forNear() at other positions: the smallest λ less the least [-].
  /// Below 0 if forNear() without spare would not find them all smooth.
  /// @param nodes positions [m]
  double spareAt(const ActiveMesh& mesh, const Field& nodes);

  /// Tells whether visit(a, b) is true for all patches a that touch a cell, and patches b whose boxes
  /// come within `margin` of that of a [m]. Pairs in one smooth rectangle are left out if their parts
  /// are farther apart than that.
  template <class Visit>
  bool allAround(const Cell& cell, double margin, const Visit& visit) {
    smooth_.clear();
    return allTouching(top_, cell, margin, visit);
  }

  /// Tells whether all smooth rectangles are sure to be still so at the end of a straight way, and to be so
  /// on it, because no tangent turns much. @param start positions at which they were smooth [m]
  bool turnsLittle(const ActiveMesh& mesh, const Field& start, const Field& end) const;

  /// The same exactly for the rectangles of the last forNear(), on the way from the positions of fit(). Those
  /// that do not stay smooth count as rough, so not as smooth, until forgetRough().
  bool staysSmooth(const ActiveMesh& mesh, const Field& end);
  void forgetRough() { rough_.assign(parts_.size(), 0); }

 private:
  using Float4 = Eigen::Vector4f;

  struct Box {
    Float4 low, high;
    void add(const Box& other) {
      low = low.cwiseMin(other.low);
      high = high.cwiseMax(other.high);
    }
  };
  /// Range of vectors, bounded in nine directions: a bend between two axes fills their box, but not the
  /// diagonal between them.
  struct Range {
    Box axes;         ///< of x, y, z
    Box sums;         ///< of x + y, y + z, z + x
    Box differences;  ///< of x - y, y - z, z - x
    static Range of(const Float4& one, const Float4& other);
    void add(const Range& other) {
      axes.add(other.axes);
      sums.add(other.sums);
      differences.add(other.differences);
    }
    Float4 middle() const { return 0.5f * (axes.low + axes.high); }
    struct Ends {
      float low, high;
    };
    Ends along(const Float4& axis) const;
  };
  /// Ranges of the two tangents [-].
  struct Tangents {
    Range warp, weft;
    void add(const Tangents& other) {
      warp.add(other.warp);
      weft.add(other.weft);
    }
  };
  struct Axes {
    Float4 first, second;
  };
  struct Part {
    int level, i, j;              ///< cell in units of its size
    int patch;                    ///< of a leaf, else -1
    std::array<int, 4> children;  ///< -1: none
  };
  /// Smoothness of 2 × 2 parts, as far as it is known; see forgetSmooth().
  enum class Square : char { Unknown, Smooth, Rough };
  /// Rectangle that was found smooth: up to 2 × 2 parts.
  struct Smooth {
    std::array<int, 4> parts;
    int count;
    Axes axes;
  };

  static float sizeOf(const Box& box) { return (box.low.cwiseAbs() + box.high.cwiseAbs()).sum(); }
  static int sizeAt(int cells, int level) { return (cells + (1 << level) - 1) >> level; }
  int at(int level, int i, int j) const {
    return level_offset_[level] + j * sizeAt(grid_.columns - 1, level) + i;
  }
  void fitNodes(const Field& nodes, const Field& motion, const std::vector<double>& margins);
  bool mayMeet(int a, int b, float margin = 0.0f) const;
  template <class Value>
  void unite(const ActiveMesh& mesh, std::vector<Value>& values) const;
  void placeNodes(const Field& nodes);
  void fitTangents(const ActiveMesh& mesh, std::vector<Tangents>& tangents) const;
  double largestTurn(const ActiveMesh& mesh, const Field& start, const Field& end) const;
  void forgetSmooth() {
    smooth_.clear();
    std::fill(squares_.begin(), squares_.end(), Square::Unknown);
  }
  bool isSmooth(const std::array<int, 4>& parts, int count);
  Tangents tangentsOf(const std::array<int, 4>& parts, int count) const;
  bool findAxes(const std::array<int, 4>& parts, int count, const Tangents& tangents, Axes& axes) const;
  /// Tells whether two parts of one level have a common corner.
  bool isBeside(int a, int b) const {
    const Part &one = parts_[a], &other = parts_[b];
    return one.level == other.level && std::abs(one.i - other.i) <= 1 && std::abs(one.j - other.j) <= 1;
  }
  bool isSmoothTogether(int a, int b);
  bool isSmoothSquare(int level, int i, int j);
  bool isInside(int level, int i, int j) const;
  static bool isSmooth(const Tangents& tangents, const Axes& axes, float least);
  static float largestMixed(const Tangents& tangents, const Axes& axes);
  static float lambda(const Tangents& tangents, const Axes& axes);

  bool touchesCell(const Part& part, const Cell& cell) const {
    const int i = part.i << part.level, j = part.j << part.level, size = 1 << part.level;
    return i <= cell.i + cell.span() && cell.i <= i + size && j <= cell.j + cell.span() && cell.j <= j + size;
  }

  template <class Visit>
  bool allTouching(int a, const Cell& cell, double margin, const Visit& visit) {
    if (!touchesCell(parts_[a], cell)) return true;
    if (parts_[a].patch >= 0) return allNear(a, top_, margin, visit);
    for (const int child : parts_[a].children) {
      if (child >= 0 && !allTouching(child, cell, margin, visit)) return false;
    }
    return true;
  }

  template <class Visit>
  bool allNear(int a, int b, double margin, const Visit& visit) {
    if (!mayMeet(a, b, static_cast<float>(margin))) return true;
    if (margin < kSmooth * nearest_ && isBeside(a, b) && isSmoothTogether(a, b)) return true;
    if (parts_[b].patch >= 0) return visit(parts_[a].patch, parts_[b].patch);
    for (const int child : parts_[b].children) {
      if (child >= 0 && !allNear(a, child, margin, visit)) return false;
    }
    return true;
  }

  template <class Visit>
  void visitSelf(int a, const Visit& visit) {
    if (isSmooth({a}, 1)) return;
    const Part& part = parts_[a];
    if (part.patch >= 0) return visit(part.patch, part.patch);
    std::array<bool, 4> smooth{};  // children that are smooth together with another
    for (int k = 0; k < 4; ++k) {
      for (int l = k + 1; l < 4; ++l) {
        const int one = part.children[k], other = part.children[l];
        if (one < 0 || other < 0) continue;
        // The rectangle around children at a diagonal is this part, which is not smooth.
        const bool diagonal = k + l == 3;
        if (!diagonal && isSmoothTogether(one, other)) {
          smooth[k] = smooth[l] = true;
        } else {
          divide(one, other, visit);
        }
      }
    }
    for (int k = 0; k < 4; ++k) {
      if (part.children[k] >= 0 && !smooth[k]) visitSelf(part.children[k], visit);
    }
  }

  template <class Visit>
  void visitPair(int a, int b, const Visit& visit) {
    if (isBeside(a, b) ? isSmoothTogether(a, b) : !mayMeet(a, b)) return;
    divide(a, b, visit);
  }

  template <class Visit>
  void divide(int a, int b, const Visit& visit) {
    if (parts_[a].patch >= 0 && parts_[b].patch >= 0) return visit(parts_[a].patch, parts_[b].patch);
    const bool divide_a = parts_[b].patch >= 0 || (parts_[a].patch < 0 && parts_[a].level >= parts_[b].level);
    for (const int child : parts_[divide_a ? a : b].children) {
      if (child >= 0) divide_a ? visitPair(child, b, visit) : visitPair(a, child, visit);
    }
  }

  // Smallest λ of a rectangle that counts as smooth, and with which it still is at the end of a step.
  // The first is that with which pairs of points keep their range (PairFinder).
  static constexpr float kSmooth = 0.5f, kStillSmooth = 0.1f;
  static constexpr float kRounding = 1e-6f;  ///< of a few sums of floats, relative

  Grid grid_;
  float least_ = kSmooth;  ///< λ with which rectangles count as smooth in the current search
  double nearest_;         ///< smallest distance in the flat cloth of parts that do not touch there [m]
  int levels_;             ///< level of the top
  int top_ = 0;
  std::vector<Part> parts_;           ///< leaves in the order of the patches, then by level
  std::vector<int> level_offset_;     ///< first index of each level in index_
  std::vector<int> index_;            ///< part at each place of each level; -1: within a coarser leaf
  std::vector<Box> boxes_, motions_;  ///< of the parts: of positions with margins, of motions [m]
  std::vector<Float4> places_;        ///< positions last given of the nodes, relative to the first [m]
  std::vector<Box> node_boxes_;       ///< places with margins [m]
  std::vector<Float4> node_motions_;  ///< [m]
  std::vector<Tangents> tangents_, tangents_after_;
  std::vector<Square> squares_;  ///< 2 × 2 parts from each place of each level on
  std::vector<Smooth> smooth_;   ///< found by the last forNear()
  std::vector<char> rough_;      ///< one flag for each part
};

}  // namespace haptic_cloth
