#include "ros/device_input.h"

#include <ros/console.h>
#include <tf2/exceptions.h>

#include "ros/conversions.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

}  // namespace

DeviceInput::DeviceInput(const NodeOptions& options, const tf2_ros::Buffer& transforms, SharedState& shared)
    : frame_id_(withoutSlash(options.frame_id)),
      device_(options.device),
      transforms_(transforms),
      shared_(shared),
      gate_(options.max_pose_age),
      filter_(options.velocity_time_constant, options.haptics.pose_timeout),
      units_(options.device.workspace_radius) {}

void DeviceInput::accept(const geometry_msgs::PoseStamped& pose) {
  StampedSample sample;
  sample.sample.received = steadyNow();
  ++counters_.received;
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
  if (!isUnit(pose.pose.orientation)) ++counters_.bad_quaternion;
  const Vec3 position = toVec3(pose.pose.position);
  checkUnits(position, sample.sample.received);
  sample.frame_id = pose.header.frame_id.empty() ? frame_id_ : pose.header.frame_id;
  sample.sample.position = placed(device_, position);
  if (!toClothFrame(withoutSlash(sample.frame_id), sample)) {
    ++counters_.unknown_frame;
    return;
  }
  sample.stamp = pose.header.stamp;
  sample.sample.stamp = pose.header.stamp.toSec();
  sample.sample.velocity = filter_.update(sample.sample.position, sample.sample.received);
  shared_.device_for_haptics.write(sample);
  shared_.device_for_solver.write(sample);
}

void DeviceInput::checkUnits(const Vec3& position, double received) {
  if (counters_.doubt != UnitDoubt::None) return;
  const UnitDoubt doubt = units_.look(device_.position_unit * position, received);
  if (doubt == UnitDoubt::None) return;
  counters_.doubt = doubt;
  ROS_WARN_STREAM(toText(doubt));
}

bool DeviceInput::toClothFrame(const std::string& frame, StampedSample& sample) const {
  if (!device_.use_tf || frame == frame_id_) return true;
  // The newest transform, not that of the stamp: a 1 kHz pose must not wait for a slower transform.
  if (!transforms_.canTransform(frame_id_, frame, ros::Time(0))) return false;
  try {
    const auto transform = transforms_.lookupTransform(frame_id_, frame, ros::Time(0));
    sample.sample.position = transformed(transform, sample.sample.position);
    sample.frame_rotation = toQuat(transform.transform.rotation).normalized();
  } catch (const tf2::TransformException&) {
    return false;  // tf2 reports by exception when the buffer was cleared in between (clock set back)
  }
  return sample.sample.position.allFinite() && sample.frame_rotation.coeffs().allFinite();
}

}  // namespace haptic_cloth
