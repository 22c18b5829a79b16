/// One probe in the haptic thread, of either kind of device.
#pragma once

#include "haptics/gain_ramp.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

class ProbeTick {
 public:
  virtual ~ProbeTick() = default;

  /// Takes over other options, the gains as they move.
  virtual void setOptions(const ProbeSettings& settings, const GainRamp& gains) = 0;

  /// Computes and sends what the device gets. @param now steady clock [s]
  virtual void tick(double now, bool paused) = 0;

  /// Sends force zero, or where the device is to stay.
  virtual void sendLast() = 0;

  /// When the newest message that the last tick knew came in, steady clock [s]; < 0: none yet.
  virtual double heard() const = 0;

  /// Whether what was sent last leaves the device at rest.
  virtual bool isQuiet() const = 0;
};

}  // namespace haptic_cloth
