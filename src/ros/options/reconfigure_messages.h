/// Between live options and the messages of dynamic_reconfigure. Pure functions.
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <vector>

#include "ros/options/live_options.h"

namespace haptic_cloth {

/// What a request says. Groups have no state here.
LiveValues toValues(const dynamic_reconfigure::Config& config);

/// All values that are in force.
dynamic_reconfigure::Config toConfig(const std::vector<LiveOption>& offered, const NodeOptions& options);

/// What there is to change, for tools: a group for every group of parameters.
dynamic_reconfigure::ConfigDescription toDescription(const std::vector<LiveOption>& offered,
                                                     const NodeOptions& options);

}  // namespace haptic_cloth
