/// Checks of a scene, with messages that locate each key.
#pragma once

#include "haptic_cloth/scene.h"
#include "scene/scene_options.h"

namespace haptic_cloth {

/// Smallest radius of a probe [m]: thinner ones would need too many samples of the cloth.
double smallestProbeRadius(const ClothOptions& cloth);

/// Checks the rules of validateScene() that concern these options. The grid is not compared with
/// adapt.levels, which cannot change. @throws InputError
void checkStepOptions(const StepOptions& options, const std::string& origin);

/// Checks the rules of validateScene(). @throws InputError with locate(key) as file
void checkScene(const Scene& scene, const Locate& locate);

}  // namespace haptic_cloth
