/// A scene back to the text that gives it: what a failed case leaves behind so that `simulate` replays it.
#pragma once

#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Scene file (scenes.md) that reads back to the same doubles. A scene does not know where its fabric
/// came from: @param fabric_file path of the fabric file, as `cloth.fabric` will have it.
std::string sceneText(const Scene& scene, const std::string& fabric_file);

}  // namespace haptic_cloth
