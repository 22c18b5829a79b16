/// Hands positions and velocities over when the mesh changes; mass and momentum are kept to round-off.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"
#include "state/archive.h"

namespace haptic_cloth {

/// State on the finest grid, indexed by particle; valid at the nodes of the mesh (ghosts hold their masters'
/// mean).
struct ParticleState {
  std::vector<Vec3> position;  ///< [m]
  std::vector<Vec3> velocity;  ///< [m/s]

  void serialize(Archive& archive) {
    archive("position", position);
    archive("velocity", velocity);
  }
};

/// Values of all particles a cell covers, bilinear in its corners.
void interpolateCell(const Grid& grid, const Cell& cell, std::vector<Vec3>& values);

/// Gives the new particles of split cells their cell's interpolation ([M04] 3.3). Momentum is kept because
/// the lumped masses are the transpose of that interpolation.
/// @param cells in the order they were split, see LeafMesh::split
void transferAfterSplit(const Grid& grid, const std::vector<Cell>& cells, ParticleState& state);

/// Hands the momentum of particles that a merge made inactive, or ghosts, to those that stay.
class MergeTransfer {
 public:
  explicit MergeTransfer(const Grid& grid);

  /// Call before the merge. @param mesh with the masses before
  void capture(const ActiveMesh& mesh, const ParticleState& state);

  /// Call after `mesh` was rebuilt on `leaves`.
  void apply(const LeafMesh& leaves, const ActiveMesh& mesh, ParticleState& state);

 private:
  void give(int node, const Vec3& momentum);

  std::vector<int> active_;     ///< particles that were active before
  std::vector<Vec3> before_;    ///< their momentum [kg·m/s]
  std::vector<Vec3> momentum_;  ///< of a node after [kg·m/s]
  std::vector<char> changed_;   ///< nodes that received momentum
};

}  // namespace haptic_cloth
