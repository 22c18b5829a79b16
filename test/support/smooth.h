/// Motion of hands from rest to rest.
#pragma once

#include <algorithm>

namespace haptic_cloth {

/// Rises from 0 at `from` to 1 at `to`, at rest at both ends; constant before and after.
inline double smooth(double time, double from, double to) {
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

}  // namespace haptic_cloth
