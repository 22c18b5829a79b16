/// When the next tick is due, so that it comes shortly after a message of the device.
#pragma once

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

/// `due` [s] of the next tick, moved a little: in the end ticks come kAnswer after the device's messages,
/// else one waits for its answer by anything up to a period. Half a period is caught up within some 30 ticks.
/// @param heard when the newest message came in, the same clock [s]; < 0: none yet  @param period [s]
inline double inPhase(double due, double heard, double period) {
  constexpr double kAnswer = 2e-4;     // what messages are late by at times [s]
  constexpr double kCatchUp = 0.1;     // of what is missing, in one tick [-]
  constexpr double kMostShift = 0.02;  // in one tick, in periods [-]
  constexpr double kSilent = 0.02;     // a device not heard for this long gives no time [s]
  if (heard < 0.0 || due - heard > kSilent) return due;
  const double late = std::remainder(due - heard - kAnswer, period);
  return due - std::clamp(kCatchUp * late, -kMostShift * period, kMostShift * period);
}

}  // namespace haptic_cloth
