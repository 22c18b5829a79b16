/// Rows of the options of the haptic loop.
#pragma once

#include <vector>

#include "haptic_cloth/haptics.h"
#include "scene/option.h"

namespace haptic_cloth {

/// Groups "haptics/", "haptics/passivity/" and "haptics/admittance/". The coupling is the scene's.
std::vector<OptionGroup> groupsOf(HapticOptions& haptics);

/// How poses are taken. The node has these rows at the top of its parameters.
Options poseOptions(HapticOptions& haptics);

}  // namespace haptic_cloth
