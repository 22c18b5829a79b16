#include "ros/force_input.h"

#include "ros/steady_clock.h"

namespace haptic_cloth {

ForceInput::ForceInput(const NodeOptions& options, const ProbeSettings& settings,
                       const tf2_ros::Buffer& transforms, SharedProbe& shared)
    : device_(settings.device),
      frames_(options.frame_id, transforms),
      shared_(shared),
      gate_(options.max_pose_age) {}

void ForceInput::accept(const geometry_msgs::WrenchStamped& wrench) {
  StampedForce force;
  force.sample.received = steadyNow();
  ++counters_.received;
  const auto& measured = wrench.wrench.force;
  const Vec3 given(measured.x, measured.y, measured.z);
  switch (gate_.judge(wrench.header, given.allFinite(), ros::Time::now())) {
    case PoseVerdict::NotFinite:
      ++counters_.not_finite;
      return;
    case PoseVerdict::OutOfOrder:
      ++counters_.out_of_order;
      return;
    case PoseVerdict::Late:
      ++counters_.late;
      return;
    case PoseVerdict::Accepted:
      break;
  }
  force.frame_id = wrench.header.frame_id.empty() ? frames_.clothFrame() : wrench.header.frame_id;
  const std::optional<Pose> frame = device_.use_tf ? frames_.find(force.frame_id) : Pose();
  if (!frame) {
    ++counters_.unknown_frame;
    return;
  }
  force.frame_rotation = frame->orientation;
  force.stamp = wrench.header.stamp;
  force.sample.force = forceAtProbe(device_, force.frame_rotation, given);
  shared_.force.write(force);
}

}  // namespace haptic_cloth
