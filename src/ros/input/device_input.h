/// Input of device poses: checked, transformed into the cloth's frame.
#pragma once

#include <geometry_msgs/PoseStamped.h>

#include <atomic>
#include <cstdint>
#include <string>

#include "ros/input/drop_counters.h"
#include "ros/input/drop_notice.h"
#include "ros/input/frame_lookup.h"
#include "ros/input/pose_gate.h"
#include "ros/input/unit_check.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Counts of received and dropped messages of a device.
struct InputCounters : DropCounters {
  std::atomic<std::uint64_t> out_of_order{0}, late{0}, other_sender{0};
  std::atomic<double> transform_age{0.0};  ///< of the frame of the last pose taken [s]
  std::atomic<UnitDoubt> doubt{UnitDoubt::None};
  std::uint64_t dropped() const { return DropCounters::dropped() + out_of_order + late + other_sender; }

  /// Counter for a message that the gate refuses; nullptr if the gate accepts it.
  std::atomic<std::uint64_t>* of(PoseVerdict verdict);
};

/// Input of one probe. Only one thread may call accept().
class DeviceInput {
 public:
  /// @param number index of the probe in the scene
  DeviceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
              SharedState& shared);

  /// @param sender name of the sending node
  void accept(const geometry_msgs::PoseStamped& pose, const std::string& sender);

  const InputCounters& counters() const { return counters_; }

 private:
  void takeOptions();
  /// @return the counter for a pose that the gate refuses; nullptr if the gate accepts it
  std::atomic<std::uint64_t>* refused(const geometry_msgs::PoseStamped& pose, const std::string& sender,
                                      double received);
  /// Warns once if the positions cannot be in metres.
  void checkUnits(const Vec3& position, double received);
  /// Remembers the orientation if it is a unit quaternion. Warns once of one that should turn the probe.
  void takeOrientation(const geometry_msgs::Quaternion& orientation, double received);

  std::string name_;  ///< of the probe
  bool is_capsule_;
  DeviceOptions device_;
  FrameLookup frames_;
  SharedProbe& shared_;
  LiveReader live_;
  PoseGate gate_;
  UnitCheck units_;
  Quat orientation_ = Quat::Identity();  ///< last good one, as given by the driver
  InputCounters counters_;
  DropNotice notice_;
};

}  // namespace haptic_cloth
