#include "ros/input/device_input.h"

#include <ros/console.h>

#include "haptic_cloth/simulation.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {
std::atomic<std::uint64_t>* InputCounters::of(PoseVerdict verdict) {
  switch (verdict) {
    case PoseVerdict::NotFinite:
      return &not_finite;
    case PoseVerdict::OtherSender:
      return &other_sender;
    case PoseVerdict::OutOfOrder:
      return &out_of_order;
    case PoseVerdict::Late:
      return &late;
    case PoseVerdict::Accepted:
      break;
  }
  return nullptr;
}

DeviceInput::DeviceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
                         SharedState& shared)
    : name_(options.scene.probes[number].name),
      is_capsule_(options.scene.probes[number].isTurned(false)),
      device_(options.probes[number].device),
      frames_(options.frame_id, transforms),
      shared_(shared.probes[number]),
      live_(shared.live_for_poses),
      gate_(options.max_pose_age, options.probes[number].haptics.pose_timeout),
      units_(device_.workspace_radius),
      notice_("poses of " + name_, frames_.clothFrame()) {}

void DeviceInput::accept(const geometry_msgs::PoseStamped& pose, const std::string& sender) {
  StampedPose taken;
  const double received = steadyNow();
  counters_.receive(received);
  shared_.sends_poses = true;
  takeOptions();
  if (std::atomic<std::uint64_t>* counter = refused(pose, sender, received)) {
    counters_.drop(*counter, received);
    return;
  }
  const Vec3 position = toVec3(pose.pose.position);
  taken.frame_id = pose.header.frame_id.empty() ? frames_.clothFrame() : pose.header.frame_id;
  const std::optional<FrameLookup::Found> frame =
      device_.use_tf ? frames_.find(taken.frame_id) : FrameLookup::Found();
  if (!frame) {
    counters_.drop(counters_.unknown_frame, received);
    warn(notice_.unknownFrame(taken.frame_id, received));
    return;
  }
  const Vec3 there = placed(device_, position);
  if (!(composed(*frame, {there, Quat::Identity()}).position.norm() < kFarthestPose)) {
    counters_.drop(counters_.too_far, received);
    warn(notice_.unusable("too far away", received));
    return;
  }
  takeOrientation(pose.pose.orientation, received);
  checkUnits(position, received);
  counters_.transform_age = frame->stamp.isZero() ? 0.0 : secondsBetween(frame->stamp, ros::Time::now());
  gate_.take(pose.header, sender, received);
  notice_.taken();
  taken.frame_position = frame->position;
  taken.frame_rotation = frame->orientation;
  taken.stamp = pose.header.stamp;
  taken.received = received;
  taken.pose = composed(*frame, {there, placed(device_, orientation_)});
  shared_.pose.write(taken);
}

void DeviceInput::takeOptions() {
  if (!live_.readNew()) return;
  const LiveOptions& live = live_.newest();
  gate_.setTimes(live.options->max_pose_age, live.options->haptics.pose_timeout);
}

std::atomic<std::uint64_t>* DeviceInput::refused(const geometry_msgs::PoseStamped& pose,
                                                 const std::string& sender, double received) {
  const ros::Time now = ros::Time::now();
  const PoseVerdict verdict = gate_.judge(pose, sender, now, received);
  if (verdict == PoseVerdict::OtherSender) warn(notice_.otherSender(sender, gate_.sender()));
  if (verdict == PoseVerdict::NotFinite) warn(notice_.unusable("not finite", received));
  if (verdict == PoseVerdict::Late)
    warn(notice_.late(secondsBetween(pose.header.stamp, now), gate_.maxAge(), received));
  return counters_.of(verdict);
}

void DeviceInput::takeOrientation(const geometry_msgs::Quaternion& orientation, double received) {
  if (isUnit(orientation)) {
    orientation_ = toQuat(orientation).normalized();
    return;
  }
  const double norm = toQuat(orientation).norm();
  if (norm != 0.0 || is_capsule_) {
    if (counters_.bad_turn < 0.0)
      ROS_WARN_STREAM("poses of " << name_ << ": quaternions of length " << norm
                                  << " instead of 1; the probe keeps its last orientation");
    counters_.bad_turn = received;
  }
  ++counters_.bad_quaternion;
}

void DeviceInput::checkUnits(const Vec3& position, double received) {
  if (counters_.doubt != UnitDoubt::None) return;
  const UnitDoubt doubt = units_.look(device_.position_unit * position, received);
  if (doubt == UnitDoubt::None) return;
  counters_.doubt = doubt;
  ROS_WARN_STREAM("poses of " << name_ << ": " << toText(doubt));
}

}  // namespace haptic_cloth
