#include "ros/obstacle_input.h"

#include "ros/conversions.h"

namespace haptic_cloth {

void ObstacleInput::accept(const geometry_msgs::PoseStamped& pose) {
  ++counters_.received;
  if (!isFinite(pose.pose)) {
    ++counters_.not_finite;
    return;
  }
  const std::optional<Pose> frame = frames_.find(pose.header.frame_id);
  if (!frame) {
    ++counters_.unknown_frame;
    return;
  }
  const Pose there = composed(*frame, toPose(pose.pose));
  if (!there.position.allFinite()) {
    ++counters_.not_finite;
    return;
  }
  if (isUnit(pose.pose.orientation)) {
    orientation_ = there.orientation.normalized();
  } else {
    ++counters_.bad_quaternion;
  }
  shared_.write({++sent_, {there.position, orientation_}});
}

}  // namespace haptic_cloth
