/// Coarser and coarser hat functions over the nodes of the mesh: what a multilevel preconditioner needs to
/// know of it.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Level l = 0, 1, ... is a lattice of 2^l finest spacings. Points on it that are not on the next one are
/// children: their values are the means of the two or four points next to them there, their parents. A hat is
/// one at a point with children and falls linearly to zero at the points around it; where the mesh is no
/// finer than the lattice there are none. Points may lie past the cloth's end; they are numbered after the
/// nodes.
class HatLevels {
 public:
  struct Child {
    int point;
    std::array<int, 4> parents;  ///< points; where it has two, each stands twice
  };

  /// Ranges of children() and hats().
  struct Level {
    int children, children_end, hats, hats_end;
  };

  explicit HatLevels(const ActiveMesh& mesh);

  /// After a change of the mesh. Allocates nothing.
  void rebuild(const ActiveMesh& mesh);

  int points() const { return static_cast<int>(place_.size()); }
  int pointCapacity() const { return static_cast<int>(place_.capacity()); }
  int hatCapacity() const { return static_cast<int>(hats_.capacity()); }

  const std::vector<Level>& levels() const { return levels_; }  ///< finest first
  const std::vector<Child>& children() const { return children_; }
  const std::vector<int>& hats() const { return hats_; }  ///< their points

  /// Of the values of a hat's children, in the shares in which they are its.
  template <class Value>
  Value sumOfChildren(int hat, const std::vector<Value>& values) const {
    Value sum = values[entries_[rows_[hat]]];
    for (int k = rows_[hat] + 1; k < rows_[hat + 1]; ++k) sum += values[entries_[k]];
    return kShare * sum;
  }
  double shares(int hat) const { return kShare * (rows_[hat + 1] - rows_[hat]); }

  static constexpr double kShare = 0.25;  ///< of a child, for each time a parent stands in it

 private:
  int pointAt(int i, int j);
  void addChildren(int span);
  void addHats(Level& level);

  int columns_ = 0;             ///< of the finest lattice, to whole coarsest spacings
  std::vector<int> number_;     ///< of the points of the finest lattice, -1: none
  std::vector<int> place_;      ///< of a point in the finest lattice
  std::vector<int> remaining_;  ///< points of the level in hand
  std::vector<Level> levels_;
  std::vector<Child> children_;
  std::vector<int> hats_, rows_, entries_;  ///< a hat's children are entries rows_[hat]..rows_[hat + 1]
  std::vector<int> hat_of_;                 ///< of a point, on the level in hand; else -1
};

}  // namespace haptic_cloth
