/// Input of obstacle poses.
#pragma once

#include <geometry_msgs/PoseStamped.h>

#include <atomic>
#include <cstdint>

#include "ros/input/frame_lookup.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// Counts of received and dropped poses since start. Written by the pose thread, read by the
/// display thread.
struct ObstacleCounters {
  std::atomic<std::uint64_t> received{0}, not_finite{0}, unknown_frame{0}, too_far{0};
  std::atomic<std::uint64_t> bad_quaternion{0};  ///< poses taken with the last good orientation
  std::atomic<double> last_dropped{-1e30};       ///< steady clock [s]
  std::atomic<const std::atomic<std::uint64_t>*> last_counter{nullptr};  ///< of the last dropped pose
  std::uint64_t dropped() const { return not_finite + unknown_frame + too_far; }

  /// @param when steady clock [s]
  void drop(std::atomic<std::uint64_t>& counter, double when) {
    ++counter;
    last_counter = &counter;
    last_dropped = when;
  }
};

/// Input of one obstacle. Only one thread may call accept().
class ObstacleInput {
 public:
  /// @param start pose in the scene
  ObstacleInput(const Pose& start, const FrameLookup& frames, Mailbox<ObstacleTarget>& shared)
      : frames_(frames), shared_(shared), orientation_(start.orientation) {}

  /// @param received steady clock [s]
  void accept(const geometry_msgs::PoseStamped& pose, double received);

  const ObstacleCounters& counters() const { return counters_; }

 private:
  FrameLookup frames_;
  Mailbox<ObstacleTarget>& shared_;
  Quat orientation_;  ///< last good one in the cloth's frame
  std::uint64_t sent_ = 0;
  ObstacleCounters counters_;
};

}  // namespace haptic_cloth
