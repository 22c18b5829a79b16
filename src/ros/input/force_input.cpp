#include "ros/input/force_input.h"

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {

ForceInput::ForceInput(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
                       SharedState& shared)
    : use_tf_(options.probes[number].device.use_tf),
      frames_(options.frame_id, transforms),
      shared_(shared.probes[number]),
      live_(shared.live_for_poses),
      silence_(options.probes[number].haptics.admittance.force_timeout),
      gate_(options.max_pose_age, silence_),
      notice_("forces of " + options.scene.probes[number].name, frames_.clothFrame()) {}

void ForceInput::takeOptions() {
  if (!live_.readNew()) return;
  gate_.setTimes(live_.newest().options->max_pose_age, silence_);
}

void ForceInput::accept(const geometry_msgs::WrenchStamped& wrench, const std::string& sender) {
  StampedForce force;
  const double received = steadyNow();
  counters_.receive(received);
  takeOptions();
  const auto& measured = wrench.wrench.force;
  const Vec3 given(measured.x, measured.y, measured.z);
  const ros::Time now = ros::Time::now();
  const PoseVerdict verdict = gate_.judge(wrench.header, given.allFinite(), sender, now, received);
  if (std::atomic<std::uint64_t>* counter = counters_.of(verdict)) {
    if (verdict == PoseVerdict::OtherSender) warn(notice_.otherSender(sender, gate_.sender()));
    if (verdict == PoseVerdict::NotFinite) warn(notice_.unusable("not finite", received));
    if (verdict == PoseVerdict::Late)
      warn(notice_.late(secondsBetween(wrench.header.stamp, now), gate_.maxAge(), received));
    counters_.drop(*counter, received);
    return;
  }
  force.frame_id = wrench.header.frame_id.empty() ? frames_.clothFrame() : wrench.header.frame_id;
  const std::optional<FrameLookup::Found> frame =
      use_tf_ ? frames_.find(force.frame_id) : FrameLookup::Found();
  if (!frame) {
    counters_.drop(counters_.unknown_frame, received);
    warn(notice_.unknownFrame(force.frame_id, received));
    return;
  }
  gate_.take(wrench.header, sender, received);
  notice_.taken();
  force.frame_rotation = frame->orientation;
  force.stamp = wrench.header.stamp;
  force.received = received;
  force.force = given;
  shared_.force.write(force);
}

}  // namespace haptic_cloth
