/// Input of device poses: checked, transformed into the cloth's frame.
#pragma once

#include <geometry_msgs/PoseStamped.h>

#include <atomic>
#include <cstdint>
#include <string>

#include "ros/input/drop_notice.h"
#include "ros/input/frame_lookup.h"
#include "ros/input/pose_gate.h"
#include "ros/input/unit_check.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Counts of received and dropped messages since start. Written by the pose thread, read by the
/// display thread.
struct InputCounters {
  std::atomic<std::uint64_t> received{0}, not_finite{0}, unknown_frame{0}, out_of_order{0}, late{0};
  std::atomic<std::uint64_t> other_sender{0}, too_far{0};
  std::atomic<std::uint64_t> bad_quaternion{0};  ///< poses taken with the last good orientation
  /// When one of these that should turn the probe last came, steady clock [s]. A device without orientation
  /// sends zeros, which do not matter to a sphere.
  std::atomic<double> bad_turn{-1e30};
  std::atomic<double> transform_age{0.0};  ///< of the frame of the last pose taken [s]
  std::atomic<UnitDoubt> doubt{UnitDoubt::None};
  std::atomic<double> last_dropped{-1e30};                               ///< steady clock [s]
  std::atomic<const std::atomic<std::uint64_t>*> last_counter{nullptr};  ///< of the last dropped message
  std::uint64_t dropped() const {
    return not_finite + unknown_frame + out_of_order + late + other_sender + too_far;
  }

  /// Counter for a message that the gate refuses; nullptr if the gate accepts it.
  std::atomic<std::uint64_t>* of(PoseVerdict verdict);

  /// @param when steady clock [s]
  void drop(std::atomic<std::uint64_t>& counter, double when) {
    ++counter;
    last_counter = &counter;
    last_dropped = when;
  }
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
  /// Warns that a second node sends poses of this probe.
  void warnOf(const std::string& sender) const;
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
