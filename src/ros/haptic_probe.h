/// One probe in the haptic thread.
#pragma once

#include <ros/publisher.h>

#include "ros/node_options.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

/// From the newest pose and snapshot of a probe to its wrench. One thread calls it.
class HapticProbe {
 public:
  /// @param settings of the probe
  HapticProbe(const std::string& frame_id, const ProbeSettings& settings, const ros::Publisher& reaction,
              SharedProbe& shared);

  /// Takes over other options, the gains as they move.
  void setOptions(const ProbeSettings& settings, const GainRamp& gains);

  /// Computes and sends the force. @param now steady clock [s]
  void tick(double now, bool paused);

  void sendZero();

  /// Whether the last force sent was zero.
  bool isQuiet() const { return force_.isZero(0.0); }

 private:
  void moveGains(double now);

  std::string frame_id_;
  DeviceOptions device_;
  HapticOptions haptics_;
  GainRamp gains_;
  bool gains_move_ = false;
  ros::Publisher reaction_;
  SharedProbe& shared_;
  HapticLoop loop_;
  Vec3 force_ = Vec3::Zero();  ///< last sent, on the probe in the cloth's frame [N]
};

}  // namespace haptic_cloth
