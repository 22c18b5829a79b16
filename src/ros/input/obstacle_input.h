/// Input of obstacle poses.
#pragma once

#include <geometry_msgs/PoseStamped.h>

#include "ros/input/drop_counters.h"
#include "ros/input/drop_notice.h"
#include "ros/input/frame_lookup.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// Input of one obstacle. Only one thread may call accept().
class ObstacleInput {
 public:
  ObstacleInput(const Obstacle& obstacle, const FrameLookup& frames, Mailbox<ObstacleTarget>& shared)
      : frames_(frames),
        shared_(shared),
        turns_(obstacle.shape != Shape::Sphere),
        orientation_(obstacle.pose.orientation),
        notice_("poses of obstacle " + obstacle.name, frames.clothFrame()) {}

  /// @param received steady clock [s]
  void accept(const geometry_msgs::PoseStamped& pose, double received);

  const DropCounters& counters() const { return counters_; }

 private:
  FrameLookup frames_;
  Mailbox<ObstacleTarget>& shared_;
  bool turns_;        ///< whether its orientation matters
  Quat orientation_;  ///< last good one in the cloth's frame
  std::uint64_t sent_ = 0;
  DropCounters counters_;
  DropNotice notice_;
};

}  // namespace haptic_cloth
