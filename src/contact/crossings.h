/// Check that the cloth does not pass through itself. It shares no code with the contact that
/// prevents it.
#pragma once

#include "haptic_cloth/report.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Finds all crossings of the surface with itself. The surface consists of two triangles for each
/// leaf; see Cell::diagonalRises(). A pair counts if a closed edge and a closed triangle have a point in
/// common and had none in the flat cloth: touching counts, neighbours do not. Signs are exact, so
/// the result does not depend on rounding. A triangle that has collapsed to a line counts for
/// nothing; its edges are still compared with other triangles.
/// @param nodes positions of all nodes [m]
Crossings findCrossings(const ActiveMesh& mesh, const Field& nodes);

}  // namespace haptic_cloth
