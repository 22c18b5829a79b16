/// The clock that all threads share.
#pragma once

#include <errno.h>
#include <time.h>

namespace haptic_cloth {

/// CLOCK_MONOTONIC [s].
inline double steadyNow() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Sleeps until `time` on the clock of steadyNow() [s].
inline void sleepUntil(double time) {
  timespec until;
  until.tv_sec = static_cast<time_t>(time);
  until.tv_nsec = static_cast<long>((time - static_cast<double>(until.tv_sec)) * 1e9);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace haptic_cloth
