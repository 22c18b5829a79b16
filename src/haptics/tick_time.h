/// Time between the ticks of a loop.
#pragma once

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

/// Notes a tick and tells the time since the last one [s]. A late tick makes up for no more than five
/// periods, so that a stall is not felt as a jump.
/// @param last time of the last tick; < 0: none [s]  @param now one that is not finite is not noted [s]
inline double timeSince(double& last, double now, double period) {
  constexpr double kMostPeriods = 5.0;
  if (!std::isfinite(now)) return period;
  const double elapsed = last >= 0.0 ? std::clamp(now - last, 0.0, kMostPeriods * period) : period;
  last = now;
  return elapsed;
}

/// Share of the force that a soft start lets through [-]. @param time that it takes, 0: none [s]
inline double risen(double share, double elapsed, double time) {
  return time > 0.0 ? std::min(1.0, share + elapsed / time) : 1.0;
}

}  // namespace haptic_cloth
