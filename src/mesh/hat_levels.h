/// Hierarchy of hat functions over the nodes of the mesh, for the multilevel preconditioner.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Lattices of points; the first has the spacing of the finest cells. From one to the next the spacing
/// doubles in both directions, or only in that in which it is much shorter, until cells are nearly square. A
/// point that is not on the next lattice is a child; its value is the mean of the two or four nearest points
/// there, its parents. Each point with children carries a hat function, which is one there and falls
/// linearly to zero at the points around it. Where the mesh is no finer than the lattice there are
/// no children. Points may lie beyond the end of the cloth. Points are numbered after the nodes;
/// nowhere() comes directly after the nodes.
///
/// Most of the preconditioner's time goes into steps from children to parents and back. Therefore
/// children with two parents are stored apart from those with four, and each hat has room for the
/// largest number of children.
class HatLevels {
 public:
  struct Child {
    int point;
    std::array<int, 4> parents;  ///< points; two parents are the first and the last
  };
  struct Hat {
    int point;
    std::array<int, 4> of_two, of_four;  ///< its children with two parents, and with four
    double shares;                       ///< sum of its weights in the means of its children
  };

  /// Spacings that double from this lattice to the next, in finest cells; 0: that direction stays as it is.
  /// Ranges of children() and hats(); children before `fours` have two parents, the others four.
  struct Level {
    std::array<int, 2> spans;
    bool doublesBoth() const { return spans[0] > 0 && spans[1] > 0; }
    int children, fours, children_end, hats, hats_end;
  };

  explicit HatLevels(const ActiveMesh& mesh);

  /// Must follow a change of the mesh. Allocates nothing.
  void rebuild(const ActiveMesh& mesh);

  int points() const { return static_cast<int>(place_.size()); }
  int pointCapacity() const { return static_cast<int>(place_.capacity()); }
  int hatCapacity() const { return static_cast<int>(hats_.capacity()); }

  const std::vector<Level>& levels() const { return levels_; }  ///< finest first
  const std::vector<Child>& children() const { return children_; }
  const std::vector<Hat>& hats() const { return hats_; }

  /// Points that are no children of any level.
  const std::vector<int>& tops() const { return remaining_; }

  /// Placeholder for missing children in hats. @pre for the loops below: its value is zero
  int nowhere() const { return nowhere_; }

  /// Adds the values of a hat's children to the value at its point, with the weights of their
  /// means.
  template <class Value>
  void gatherChildren(const Hat& hat, Value* values) const {
    const auto& two = hat.of_two;
    const auto& four = hat.of_four;
    const Value twos = values[two[0]] + values[two[1]] + values[two[2]] + values[two[3]],
                fours = values[four[0]] + values[four[1]] + values[four[2]] + values[four[3]];
    values[hat.point] += 0.5f * (twos + 0.5f * fours);
  }

  /// Sets the values of children begin..end, counted within their level, to the means of their
  /// parents.
  template <class Value>
  void interpolate(const Level& level, int begin, int end, Value* values) const {
    const Child* child = children_.data() + level.children + begin;
    const Child* const last = children_.data() + level.children + end;
    for (const Child* const fours = children_.data() + level.fours; child < std::min(fours, last); ++child) {
      const auto& p = child->parents;
      values[child->point] = 0.5f * (values[p[0]] + values[p[3]]);
    }
    for (; child < last; ++child) {
      const auto& p = child->parents;
      values[child->point] = 0.25f * (values[p[0]] + values[p[1]] + values[p[2]] + values[p[3]]);
    }
  }

 private:
  /// Place of a point in the finest lattice.
  struct Place {
    int i, j;
  };

  int& numberAt(int i, int j);
  int pointAt(int i, int j);
  void addChildren(Level& level);
  void addHats(Level& level);

  Grid grid_;
  std::vector<int> number_;     ///< see numberAt()
  std::vector<Place> place_;    ///< of each point
  std::vector<int> remaining_;  ///< points of the current level
  std::vector<Level> levels_;
  std::vector<Child> children_;
  std::vector<Hat> hats_;
  int nowhere_ = 0;
  std::vector<int> hat_of_;  ///< hat of each point on the current level, otherwise -1
};

}  // namespace haptic_cloth
