/// Division of cells that lie across sharp edges of an obstacle. Model: decision 0041.
#pragma once

#include <array>
#include <vector>

#include "contact/candidates.h"
#include "contact/cloth_gaps.h"

namespace haptic_cloth {

/// Lays lines for the samples of cells near edges. Cloth presses on an edge with a strip about as wide as the
/// range of contact, wherever its nodes lie.
class EdgeDivision {
 public:
  static constexpr double kCut = 0.5;  ///< length of short parts, and how deep a round solid may cut [ranges]
  static constexpr double kMostParts = 4.0;  ///< of a finest cell on a round solid, at most

  /// @param range of contact [m]  @param gaps of the nodes from the obstacle with sharp edges
  EdgeDivision(const Grid& grid, double range, const ClothGaps& gaps);

  /// Finds the nodes that are nearer to a sharp edge than the range, and how far the obstacle's normal turns
  /// there along warp and weft. @param sharp the obstacle, with sharp edges
  void find(const Solid& sharp, const ActiveMesh& mesh, const Field& nodes);

  /// Divides a cell near an edge into parts. In the strip they are a share of the range long across the edge;
  /// elsewhere they are as long as finest cells.
  /// @param solid the obstacle  @return whether the cell is near an edge; else no lines are laid  @pre find()
  bool divide(const Solid& solid, const Patch& patch, const Field& nodes, CellLines& lines) const;

  /// Divides a finest cell that a probe may dent over an edge into parts as long as the range. They must not
  /// follow the pressure, see SampleFinder::mayBeDented(); those of divide() do.
  /// @return whether an edge may press on the cell; else no lines are laid
  bool divideEvenly(const Solid& solid, const Patch& patch, const Field& nodes, CellLines& lines) const;

 private:
  void noteEdge(const Solid& sharp, const Field& nodes, int node, int towards, double turn,
                std::vector<double>& turns) const;
  double edgeTurn(const Solid& solid, const Patch& patch, int direction) const;
  bool mayTouchCorner(const Solid& solid, const Patch& patch, const Field& nodes) const;
  int partsAlong(const Solid& solid, int direction) const;
  bool isTilted(const Patch& patch, int direction) const;
  std::array<double, 2> strip(const Patch& patch, int direction, bool within, const Field& nodes) const;

  Grid grid_;
  double range_;
  const ClothGaps& gaps_;
  std::array<std::vector<double>, 2> turns_;  ///< of the normal at the nodes, along warp and weft [rad]
};

}  // namespace haptic_cloth
