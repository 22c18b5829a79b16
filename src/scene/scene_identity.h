/// Part of a scene that a saved state depends on.
#pragma once

#include "haptic_cloth/scene.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Saves this part, or compares it with a saved one: everything that a step depends on. Not
/// included are inputs of a run: paths and grasps, stop conditions, threads and the wall clock
/// budget.
/// @throws InputError naming the first key that differs
void serializeIdentity(Archive& archive, const Scene& scene);

}  // namespace haptic_cloth
