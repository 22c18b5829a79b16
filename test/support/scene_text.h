/// Text of a scene, so that `simulate` can replay a failed case.
#pragma once

#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Writes a scene file (scenes.md) that reads back to the same doubles.
/// @param fabric_file path for `cloth.fabric`; a scene does not know where its fabric came from
std::string sceneText(const Scene& scene, const std::string& fabric_file);

}  // namespace haptic_cloth
