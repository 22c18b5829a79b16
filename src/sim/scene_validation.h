/// Checks of a scene, with messages that locate each key.
#pragma once

#include <functional>
#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Maps a key to its place in the source, for messages ("cloth.size[0]" → "scene.yaml:3").
using Locate = std::function<std::string(const std::string& key)>;

/// Smallest radius of a probe [m]: thinner ones would need too many samples of the cloth.
double smallestProbeRadius(const ClothOptions& cloth);

/// Checks the rules of validateScene(). @throws InputError with locate(key) as file
void checkScene(const Scene& scene, const Locate& locate);

}  // namespace haptic_cloth
