/// Tolerances of the tests, scaled by one environment variable.
#pragma once

#include <cstdlib>

namespace haptic_cloth {

/// Returns `value` times $HAPTIC_CLOTH_TOLERANCE_SCALE (default 1). With 0 every comparison fails
/// and prints the true residual.
inline double tolerance(double value) {
  const char* scale = std::getenv("HAPTIC_CLOTH_TOLERANCE_SCALE");
  return scale == nullptr ? value : value * std::strtod(scale, nullptr);
}

}  // namespace haptic_cloth
