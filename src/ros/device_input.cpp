#include "ros/device_input.h"

#include <ros/console.h>

#include "ros/conversions.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {

DeviceInput::DeviceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
                         SharedState& shared)
    : device_(options.probes[number].device),
      frames_(options.frame_id, transforms),
      shared_(shared.probes[number]),
      live_(shared.live_for_poses),
      gate_(options.max_pose_age),
      filter_(options.velocity_time_constant, options.haptics.pose_timeout),
      units_(device_.workspace_radius) {}

void DeviceInput::accept(const geometry_msgs::PoseStamped& pose) {
  StampedSample sample;
  sample.sample.received = steadyNow();
  ++counters_.received;
  takeOptions();
  switch (gate_.judge(pose, ros::Time::now())) {
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
  takeOrientation(pose.pose.orientation);
  const Vec3 position = toVec3(pose.pose.position);
  checkUnits(position, sample.sample.received);
  sample.frame_id = pose.header.frame_id.empty() ? frames_.clothFrame() : pose.header.frame_id;
  const std::optional<Pose> frame = device_.use_tf ? frames_.find(sample.frame_id) : Pose();
  const Pose placed_pose{placed(device_, position), placed(device_, orientation_)};
  const Pose there = composed(frame.value_or(Pose()), placed_pose);
  if (!frame || !there.position.allFinite()) {
    ++counters_.unknown_frame;
    return;
  }
  sample.frame_position = frame->position;
  sample.frame_rotation = frame->orientation;
  sample.orientation = there.orientation.normalized();
  sample.stamp = pose.header.stamp;
  sample.sample.stamp = pose.header.stamp.toSec();
  sample.sample.position = there.position;
  sample.sample.velocity = filter_.update(sample.sample.position, sample.sample.received);
  shared_.device_for_haptics.write(sample);
  if (device_.kind == DeviceKind::Impedance) shared_.device_for_solver.write(sample);
}

void DeviceInput::takeOptions() {
  const LiveOptions& live = live_.read();
  if (live.number == options_seen_) return;
  options_seen_ = live.number;
  gate_.setMaxAge(live.options->max_pose_age);
  filter_.setTimes(live.options->velocity_time_constant, live.options->haptics.pose_timeout);
}

void DeviceInput::takeOrientation(const geometry_msgs::Quaternion& orientation) {
  if (isUnit(orientation)) {
    orientation_ = toQuat(orientation).normalized();
  } else {
    ++counters_.bad_quaternion;
  }
}

void DeviceInput::checkUnits(const Vec3& position, double received) {
  if (counters_.doubt != UnitDoubt::None) return;
  const UnitDoubt doubt = units_.look(device_.position_unit * position, received);
  if (doubt == UnitDoubt::None) return;
  counters_.doubt = doubt;
  ROS_WARN_STREAM(toText(doubt));
}

}  // namespace haptic_cloth
