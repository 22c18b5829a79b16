/// Age of what was received, on one steady clock.
#pragma once

#include <cmath>

namespace haptic_cloth {

/// Tells whether something was received within `timeout` of `now` [s]. A time that lies ahead by more is of
/// another clock: it would never grow old.
inline bool isFresh(double received, double now, double timeout) {
  return std::abs(now - received) <= timeout;
}

/// Makes a time of another clock, which lies ahead, that of nothing received: it must neither keep later ones
/// out nor count when its time comes [s].
inline void forgetAhead(double& received, double now, double timeout) {
  if (received > now + timeout) received = -1.0;
}

}  // namespace haptic_cloth
