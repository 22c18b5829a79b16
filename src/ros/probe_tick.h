/// One probe in the haptic thread, of either kind of device.
#pragma once

namespace haptic_cloth {

class ProbeTick {
 public:
  virtual ~ProbeTick() = default;

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
