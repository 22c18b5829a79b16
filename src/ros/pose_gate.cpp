#include "ros/pose_gate.h"

#include "ros/conversions.h"

namespace haptic_cloth {
namespace {

/// Stamps that fall back by more than this come from a clock that was set, not from a late message [s].
constexpr double kClockJump = 1.0;

}  // namespace

PoseVerdict PoseGate::judge(const geometry_msgs::PoseStamped& pose, const ros::Time& now) {
  return judge(pose.header, isFinite(pose.pose), now);
}

PoseVerdict PoseGate::judge(const std_msgs::Header& header, bool finite, const ros::Time& now) {
  if (!finite) return PoseVerdict::NotFinite;
  const ros::Time stamp = header.stamp;
  if (stamp.isZero()) return PoseVerdict::Accepted;
  if (max_age_ > 0.0 && (now - stamp).toSec() > max_age_) return PoseVerdict::Late;
  if (stamp < last_ && (last_ - stamp).toSec() <= kClockJump) return PoseVerdict::OutOfOrder;
  last_ = stamp;
  return PoseVerdict::Accepted;
}

}  // namespace haptic_cloth
