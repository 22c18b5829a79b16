/// Device poses on their way in: checked, moved into the cloth's frame, filtered.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <tf2_ros/buffer.h>

#include <atomic>
#include <cstdint>
#include <string>

#include "haptics/velocity_filter.h"
#include "ros/node_options.h"
#include "ros/pose_gate.h"
#include "ros/shared_state.h"
#include "ros/unit_check.h"

namespace haptic_cloth {

/// What became of the poses since start. Written by the pose callback, read by the display thread.
struct InputCounters {
  std::atomic<std::uint64_t> received{0}, not_finite{0}, unknown_frame{0}, out_of_order{0}, late{0};
  std::atomic<std::uint64_t> bad_quaternion{0};  ///< taken all the same: a sphere has no orientation
  std::atomic<UnitDoubt> doubt{UnitDoubt::None};
  std::uint64_t dropped() const { return not_finite + unknown_frame + out_of_order + late; }
};

/// One thread calls accept().
class DeviceInput {
 public:
  DeviceInput(const NodeOptions& options, const tf2_ros::Buffer& transforms, SharedState& shared);

  void accept(const geometry_msgs::PoseStamped& pose);

  const InputCounters& counters() const { return counters_; }

 private:
  /// Warns once when the positions cannot be metres.
  void checkUnits(const Vec3& position, double received);
  /// Brings the sample's position from the frame of the pose into the cloth's. @return false without a
  /// transform
  bool toClothFrame(const std::string& frame, StampedSample& sample) const;

  std::string frame_id_;
  DeviceOptions device_;
  const tf2_ros::Buffer& transforms_;
  SharedState& shared_;
  PoseGate gate_;
  VelocityFilter filter_;
  UnitCheck units_;
  InputCounters counters_;
};

}  // namespace haptic_cloth
