/// The options of one probe whose gains move while the node runs.
#pragma once

#include "haptics/gain_ramp.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

class MovingGains {
 public:
  explicit MovingGains(const ProbeSettings& settings)
      : device_(settings.device), haptics_(settings.haptics) {}

  /// The device is described as it starts; of what it says only the force scale, a gain, changes.
  const DeviceOptions& device() const { return device_; }

  void set(const ProbeSettings& settings, const GainRamp& gains) {
    haptics_ = settings.haptics;
    gains_ = gains;
    moves_ = true;
  }

  /// Gives take(options, unit) the limits at the probe as the gains are now, while they move. `unit`: new
  /// force scale over the one before. @param now steady clock [s]
  template <class Take>
  void move(double now, const Take& take) {
    if (!moves_) return;
    moves_ = !gains_.isDone(now);
    const Gains gains = gains_.at(now);
    haptics_.coupling_stiffness = gains.coupling_stiffness;
    haptics_.coupling_damping = gains.coupling_damping;
    const double unit = gains.force_scale / device_.force_scale;
    device_.force_scale = gains.force_scale;
    take(limitsAtProbe(haptics_, device_), unit);
  }

 private:
  DeviceOptions device_;
  HapticOptions haptics_;
  GainRamp gains_;
  bool moves_ = false;
};

}  // namespace haptic_cloth
