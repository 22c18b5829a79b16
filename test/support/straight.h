/// Places and forces of a device that does not turn.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Place of a device that has not turned, or force without a torque.
inline Vec6 straight(double x, double y, double z) { return joined(Vec3(x, y, z), Vec3::Zero()); }

}  // namespace haptic_cloth
