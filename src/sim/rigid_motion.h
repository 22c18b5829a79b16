/// Motion of the whole cloth as a rigid body.
#pragma once

#include "haptic_cloth/types.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Field of vectors that a rigid body could have: mean + turn × (x - centre).
struct RigidMotion {
  Vec3 centre = Vec3::Zero();  ///< [m]
  Vec3 mean = Vec3::Zero();    ///< unit of the vectors
  Vec3 turn = Vec3::Zero();    ///< unit of the vectors over [m]

  Vec3 at(const Vec3& x) const { return mean + turn.cross(x - centre); }
};

/// The rigid motion with the same sum over the active nodes of m v, and of m x × v.
/// @param vectors v of the nodes at the positions x [m]
RigidMotion rigidMotion(const ActiveMesh& mesh, const Field& positions, const Field& vectors);

}  // namespace haptic_cloth
