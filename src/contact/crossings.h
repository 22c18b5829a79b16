/// Check that the cloth does not pass through itself. It shares no code with the contact that
/// prevents it.
#pragma once

#include "haptic_cloth/report.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Finds all crossings of the surface with itself. The surface consists of two triangles for each
/// leaf; see diagonalRises(). A pair counts if a closed edge and a closed triangle have a point in
/// common and had none in the flat cloth: touching counts, neighbours do not. Signs are exact, so
/// the result does not depend on rounding. A triangle that has collapsed to a line counts for
/// nothing; its edges are still compared with other triangles.
/// @param nodes positions of all nodes [m]
Crossings findCrossings(const ActiveMesh& mesh, const Field& nodes);

/// Tells whether a leaf is cut from its corner (i,j) to (i+s,j+s), not from (i+s,j) to (i,j+s). The
/// children of a leaf refine the diagonal of their parent, and mirror images have mirrored ones.
inline bool diagonalRises(const Cell& cell) {
  return ((cell.i >> cell.level) + (cell.j >> cell.level)) % 2 == 0;
}

}  // namespace haptic_cloth
