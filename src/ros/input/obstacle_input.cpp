#include "ros/input/obstacle_input.h"

#include "haptic_cloth/simulation.h"
#include "ros/node/conversions.h"

namespace haptic_cloth {

void ObstacleInput::accept(const geometry_msgs::PoseStamped& pose, double received) {
  counters_.receive(received);
  if (!isFinite(pose.pose)) {
    counters_.drop(counters_.not_finite, received);
    warn(notice_.unusable("not finite", received));
    return;
  }
  const std::optional<FrameLookup::Found> frame = frames_.find(pose.header.frame_id);
  if (!frame) {
    counters_.drop(counters_.unknown_frame, received);
    warn(notice_.unknownFrame(pose.header.frame_id, received));
    return;
  }
  const Pose there = composed(*frame, toPose(pose.pose));
  if (!(there.position.norm() < kFarthestPose)) {
    counters_.drop(counters_.too_far, received);
    warn(notice_.unusable("too far away", received));
    return;
  }
  if (isUnit(pose.pose.orientation)) {
    orientation_ = there.orientation.normalized();
  } else {
    ++counters_.bad_quaternion;
    if (turns_) counters_.bad_turn = received;
  }
  notice_.taken();
  shared_.write({++sent_, {there.position, orientation_}});
}

}  // namespace haptic_cloth
