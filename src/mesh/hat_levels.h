/// Coarser and coarser hat functions over the nodes of the mesh: what a multilevel preconditioner needs to
/// know of it.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Level l = 0, 1, ... is a lattice of 2^l finest spacings. Points on it that are not on the next one are
/// children: their values are the means of the two or four points next to them there, their parents. A hat is
/// one at a point with children and falls linearly to zero at the points around it; where the mesh is no
/// finer than the lattice there are none. Points may lie past the cloth's end; they are numbered after the
/// nodes, and last comes nowhere().
/// Going from children to parents and back is most of what a preconditioner takes: children of two and of
/// four parents stand apart, and every hat has places for as many as there can be.
class HatLevels {
 public:
  struct Child {
    int point;
    std::array<int, 4> parents;  ///< points; where it has two, these are the first and the last
  };
  struct Hat {
    int point;
    std::array<int, 4> of_two, of_four;  ///< points: its children that have two parents, and four
    double shares;                       ///< sum of those in which they are its
  };

  /// Ranges of children() and hats(); children before `fours` have two parents, the others four.
  struct Level {
    int children, fours, children_end, hats, hats_end;
  };

  explicit HatLevels(const ActiveMesh& mesh);

  /// After a change of the mesh. Allocates nothing.
  void rebuild(const ActiveMesh& mesh);

  int points() const { return static_cast<int>(place_.size()); }
  int pointCapacity() const { return static_cast<int>(place_.capacity()); }
  int hatCapacity() const { return static_cast<int>(hats_.capacity()); }

  const std::vector<Level>& levels() const { return levels_; }  ///< finest first
  const std::vector<Child>& children() const { return children_; }
  const std::vector<Hat>& hats() const { return hats_; }
  const std::vector<int>& tops() const { return remaining_; }  ///< points that are no children

  /// Stands in hats for children that there are not. @pre for the loops below: its value is zero
  int nowhere() const { return nowhere_; }

  /// Adds to the value at a hat's point those of its children, in the shares in which they are its.
  template <class Value>
  void gatherChildren(const Hat& hat, Value* values) const {
    const auto& two = hat.of_two;
    const auto& four = hat.of_four;
    const Value twos = values[two[0]] + values[two[1]] + values[two[2]] + values[two[3]],
                fours = values[four[0]] + values[four[1]] + values[four[2]] + values[four[3]];
    values[hat.point] += 0.5f * (twos + 0.5f * fours);
  }

  /// Sets the values of children begin..end, counted in their level, by those of their parents.
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
  int pointAt(int i, int j);
  void addChildren(Level& level, int span);
  void addHats(Level& level);

  int columns_ = 0;             ///< of the finest lattice, to whole coarsest spacings
  std::vector<int> number_;     ///< of the points of the finest lattice, -1: none
  std::vector<int> place_;      ///< of a point in the finest lattice
  std::vector<int> remaining_;  ///< points of the level in hand
  std::vector<Level> levels_;
  std::vector<Child> children_;
  std::vector<Hat> hats_;
  int nowhere_ = 0;
  std::vector<int> hat_of_;  ///< of a point, on the level in hand; else -1
};

}  // namespace haptic_cloth
