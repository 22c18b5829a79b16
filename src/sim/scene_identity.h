/// What of a scene a state belongs to.
#pragma once

#include "haptic_cloth/scene.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Saves it, or compares what was saved with this scene: everything a step depends on. Left out is what a run
/// is told from outside: paths and grasps, when it stops, threads and the wall clock's budget.
/// @throws InputError naming the first key that differs
void serializeIdentity(Archive& archive, const Scene& scene);

}  // namespace haptic_cloth
