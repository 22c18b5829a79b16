#include "ros/input/frame_lookup.h"

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>
#include <tf2_ros/buffer.h>

#include "ros/node/conversions.h"

namespace haptic_cloth {
FrameLookup::FrameLookup(const std::string& frame_id, const tf2_ros::Buffer& transforms)
    : frame_id_(frame_id), transforms_(transforms) {}

std::optional<FrameLookup::Found> FrameLookup::find(const std::string& frame) const {
  const std::string name = withoutSlash(frame);
  if (name.empty() || name == frame_id_) return Found();
  // The newest transform is used, not that at the stamp: a 1 kHz pose must not wait for slower
  // transforms.
  if (!transforms_.canTransform(frame_id_, name, ros::Time(0))) return std::nullopt;
  try {
    const geometry_msgs::TransformStamped newest = transforms_.lookupTransform(frame_id_, name, ros::Time(0));
    const Found found{toPose(newest), newest.header.stamp};
    if (found.position.allFinite() && found.orientation.coeffs().allFinite()) return found;
  } catch (const tf2::TransformException&) {
    // tf2 throws if the buffer was cleared after canTransform(), for instance by a clock set back.
  }
  return std::nullopt;
}

}  // namespace haptic_cloth
