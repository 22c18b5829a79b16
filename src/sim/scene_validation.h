/// Checks of a scene with messages that know where each key was written.
#pragma once

#include <functional>
#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Place of a key in its source, for messages ("cloth.size[0]" → "scene.yaml:3").
using Locate = std::function<std::string(const std::string& key)>;

/// Smallest radius of a probe [m]: thinner ones would need too many samples of the cloth.
double smallestProbeRadius(const ClothOptions& cloth);

/// The rules of validateScene(). @throws InputError with locate(key) as file
void checkScene(const Scene& scene, const Locate& locate);

}  // namespace haptic_cloth
