/// Transfer of positions and velocities when the mesh changes; keeps mass and momentum to
/// round-off.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"
#include "state/archive.h"

namespace haptic_cloth {

/// State on the finest grid, indexed by particle. It is valid at the nodes of the mesh; hanging
/// nodes have the mean of their masters.
struct ParticleState {
  std::vector<Vec3> position;  ///< [m]
  std::vector<Vec3> velocity;  ///< [m/s]
  /// For BDF2, else empty: changes of position [m] and velocity [m/s] in the last step.
  std::vector<Vec3> moved, gained;

  void serialize(Archive& archive) {
    archive("position", position);
    archive("velocity", velocity);
    if (moved.empty()) return;
    archive("moved", moved);
    archive("gained", gained);
  }
};

/// Interpolates the values of all particles that a cell covers from its corners, bilinearly.
void interpolateCell(const Grid& grid, const Cell& cell, std::vector<Vec3>& values);

/// Gives the new particles of split cells the interpolated values of their cell ([M04] 3.3). This
/// keeps momentum, because mass lumping is the transpose of that interpolation. A new centre leaves
/// the triangles of its cell (TriangleSurface) if the cell is twisted.
/// @param cells in the order of the splits, see LeafMesh::split()
/// @param crowded flag for each finest cell: cells with their lower left corner there have no room for
/// that, so their centre is placed on their diagonal
void transferAfterSplit(const Grid& grid, const std::vector<Cell>& cells, const std::vector<char>& crowded,
                        ParticleState& state);

/// Largest distance by which the surface moves when a leaf is split [m].
double movedBySplit(const Grid& grid, const Cell& cell, const std::vector<Vec3>& positions);

/// Largest distance by which the surface moves when four leaves merge into `parent` [m].
double movedByMerge(const Grid& grid, const Cell& parent, const std::vector<Vec3>& positions);

/// Hands over the momentum of particles that were removed or now hang, after a merge. What BDF2 keeps
/// of the last step moves on with the mass like velocity.
class MergeTransfer {
 public:
  explicit MergeTransfer(const Grid& grid);

  /// Records the masses. Called before the merge.
  void capture(const ActiveMesh& mesh);

  /// Call after `mesh` was rebuilt on `leaves`.
  void apply(const LeafMesh& leaves, const ActiveMesh& mesh, ParticleState& state);

 private:
  void give(int node, const Vec3& momentum);
  void apply(const LeafMesh& leaves, const ActiveMesh& mesh, std::vector<Vec3>& values);

  std::vector<int> active_;     ///< particles that were active before
  std::vector<double> masses_;  ///< and their masses before [kg]
  std::vector<Vec3> before_;    ///< their momentum [kg·m/s]
  std::vector<Vec3> momentum_;  ///< momentum of each node after [kg·m/s]
  std::vector<char> changed_;   ///< nodes that received momentum
};

}  // namespace haptic_cloth
