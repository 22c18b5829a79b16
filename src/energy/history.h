/// Memory of the fabric while the mesh changes: forces per width as fields over the finest grid.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/zeros.h"

namespace haptic_cloth {

/// Tension, moment and shear force of the elements. They are recorded before a change of the mesh,
/// handed over cell by cell and read by the new elements. All are per unit width, so splitting
/// copies and merging averages; in the total forces of [M04] 3.3 that is "half of T2 to T1 and T3",
/// "E2 + E3 add" and "f/4 to each finer edge".
class ForceHistory {
 public:
  explicit ForceHistory(const Grid& grid);

  /// Tension [N/m] of the sides of a leaf: warp sides below and above, weft sides left and right.
  using Sides = std::array<double, 4>;

  Sides& sides(const Cell& cell) { return sides_[grid_.cell(cell.i, cell.j)]; }
  double& shear(const Cell& cell) { return shear_[grid_.cell(cell.i, cell.j)]; }        ///< [N/m]
  double& moment(int particle, int direction) { return bending(particle)[direction]; }  ///< [N·m/m]

  /// Curvature at which the moment was recorded [1/m]. Right after a split the new triples have a
  /// very different curvature, that of a kinked surface, at which the loop would not allow the
  /// moment.
  double& curvature(int particle, int direction) { return bending(particle)[2 + direction]; }

  /// Must precede the recording of moments: free borders have none, but merges leave some there.
  void clearBending();

  /// Hand over the state of a merged parent or a split cell. Called for each merged parent, then
  /// for each split cell in the order of the splits.
  void merge(const Cell& parent);
  void split(const Cell& parent);

 private:
  using Bending = std::array<double, 4>;  ///< moments of warp and weft, curvatures of warp and weft
  static constexpr int kPage = 128;       ///< number of particles in a page of memory

  Bending& bending(int particle) {
    used_[particle / kPage] = 1;
    return bending_[particle];
  }
  void mergeBending(const Cell& parent);
  std::array<Cell, 4> children(const Cell& parent) const;

  Grid grid_;
  Zeros<Sides> sides_;
  Zeros<double> shear_;
  Zeros<Bending> bending_;
  std::vector<char> used_;  ///< pages of bending_ that may have nonzero entries
};

}  // namespace haptic_cloth
