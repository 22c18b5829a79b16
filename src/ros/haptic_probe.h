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

  /// Computes and sends the force. @param now steady clock [s]
  void tick(double now, bool paused);

  void sendZero();

  /// Whether the last force sent was zero.
  bool isQuiet() const { return felt_.force.isZero(0.0); }

 private:
  std::string frame_id_;
  DeviceOptions device_;
  ros::Publisher reaction_;
  SharedProbe& shared_;
  HapticLoop loop_;
  FeltForce felt_;  ///< of the last tick
};

}  // namespace haptic_cloth
