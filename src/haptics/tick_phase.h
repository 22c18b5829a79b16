/// Time of the next tick, chosen so that it comes shortly after a message of the device.
#pragma once

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

constexpr double kSilentDevice = 0.02;  ///< after this silence a device does not count [s]

/// Moves the time of the next tick a little, until ticks come kAnswer after the messages of the
/// device. Otherwise a message would wait for its answer by up to a period. Half a period is made up
/// within 60 ticks.
/// @param due planned time of the tick [s]
/// @param heard time of the newest message, on the same clock [s]; < 0: none yet
/// @param period [s]
inline double inPhase(double due, double heard, double period) {
  constexpr double kAnswer = 2e-4;     // usual lateness of messages [s]
  constexpr double kCatchUp = 0.1;     // share of the error that one tick corrects [-]
  constexpr double kMostShift = 0.02;  // largest shift of one tick, in periods [-]
  if (heard < 0.0 || due - heard > kSilentDevice) return due;
  const double late = std::remainder(due - heard - kAnswer, period);
  return due - std::clamp(kCatchUp * late, -kMostShift * period, kMostShift * period);
}

}  // namespace haptic_cloth
