/// Input of measured forces: checked, with the rotation of their frame in the cloth's.
#pragma once

#include <geometry_msgs/WrenchStamped.h>

#include "ros/input/device_input.h"

namespace haptic_cloth {

/// Input of one probe with an admittance device. Only one thread may call accept().
class ForceInput {
 public:
  /// @param number index of the probe in the scene
  ForceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
             SharedState& shared);

  /// @param wrench its force is that of the hand on the device; its torque is ignored
  /// @param sender name of the sending node
  void accept(const geometry_msgs::WrenchStamped& wrench, const std::string& sender);

  const InputCounters& counters() const { return counters_; }

 private:
  void takeOptions();

  bool use_tf_;  ///< see DeviceOptions
  FrameLookup frames_;
  SharedProbe& shared_;
  LiveReader live_;
  double silence_;  ///< see PoseGate [s]
  PoseGate gate_;
  InputCounters counters_;
  DropNotice notice_;
};

}  // namespace haptic_cloth
