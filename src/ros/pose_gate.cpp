#include "ros/pose_gate.h"

#include "ros/conversions.h"

namespace haptic_cloth {
namespace {

/// Stamps that fall back by more than this come from a clock that was set, not from a late message [s].
constexpr double kClockJump = 1.0;

}  // namespace

PoseVerdict PoseGate::judge(const geometry_msgs::PoseStamped& pose, const std::string& sender,
                            const ros::Time& now, double received) const {
  if (!isFinite(pose.pose)) return PoseVerdict::NotFinite;
  const bool silent = received - received_ > silence_;
  if (!silent && sender != sender_) return PoseVerdict::OtherSender;
  const ros::Time stamp = pose.header.stamp;
  if (stamp.isZero()) return PoseVerdict::Accepted;
  if (max_age_ > 0.0 && (now - stamp).toSec() > max_age_) return PoseVerdict::Late;
  if (!silent && stamp < last_ && (last_ - stamp).toSec() <= kClockJump) return PoseVerdict::OutOfOrder;
  return PoseVerdict::Accepted;
}

void PoseGate::take(const geometry_msgs::PoseStamped& pose, const std::string& sender, double received) {
  if (!pose.header.stamp.isZero()) last_ = pose.header.stamp;
  received_ = received;
  if (sender != sender_) sender_ = sender;
}

}  // namespace haptic_cloth
