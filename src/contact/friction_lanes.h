/// Smoothed Coulomb friction in lanes.
#pragma once

#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

/// SmoothSlip (friction_law.h) without its slope.
struct SlipLanes {
  Lanes potential;  ///< f0 [m]
  Lanes ratio;      ///< f0'/y [1/m]
};

/// smoothSlip() of a slip in the tangent plane [m].
HAPTIC_CLOTH_INLINE SlipLanes smoothSlip(const Lanes3& slip, double epsilon) {
  const Lanes y = squareRoot(dot(slip, slip)), t = y / epsilon, short_end = all(epsilon);
  return {ifLess(y, short_end, short_end * t * t * (1.0 - t / 3.0), y - short_end / 3.0),
          ifLess(y, short_end, (2.0 - t) / short_end, 1.0 / larger(y, short_end))};
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
