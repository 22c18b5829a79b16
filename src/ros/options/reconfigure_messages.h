/// Conversions between live options and the messages of dynamic_reconfigure. Pure functions.
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <vector>

#include "ros/options/live_options.h"

namespace haptic_cloth {

/// Values in a request. The state of groups is ignored.
LiveValues toValues(const dynamic_reconfigure::Config& config);

/// All current values.
dynamic_reconfigure::Config toConfig(const std::vector<LiveOption>& offered, const NodeOptions& options);

/// Description of all live options for the tools: one group per group of parameters.
dynamic_reconfigure::ConfigDescription toDescription(const std::vector<LiveOption>& offered,
                                                     const NodeOptions& options);

}  // namespace haptic_cloth
