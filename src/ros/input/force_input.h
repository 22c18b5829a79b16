/// Measured forces on their way in: checked, turned into the cloth's frame.
#pragma once

#include <geometry_msgs/WrenchStamped.h>

#include "ros/input/device_input.h"

namespace haptic_cloth {

/// Of one probe whose device is of the admittance kind. One thread calls accept().
class ForceInput {
 public:
  /// @param number of the probe in the scene
  ForceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
             SharedState& shared);

  /// @param wrench whose force the hand exerts on the device; its torque is not used
  /// @param sender name of the node that sent it
  void accept(const geometry_msgs::WrenchStamped& wrench, const std::string& sender);

  const InputCounters& counters() const { return counters_; }

 private:
  void takeOptions();

  DeviceOptions device_;
  FrameLookup frames_;
  SharedProbe& shared_;
  LiveReader live_;
  double silence_;  ///< see PoseGate [s]
  PoseGate gate_;
  InputCounters counters_;
  DropNotice notice_;
};

}  // namespace haptic_cloth
