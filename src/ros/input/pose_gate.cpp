#include "ros/input/pose_gate.h"

#include "ros/node/conversions.h"

namespace haptic_cloth {
namespace {

/// Stamps that fall back by more than this mean that the clock was set, not that a message is late
/// [s].
constexpr double kClockJump = 1.0;

}  // namespace

PoseVerdict PoseGate::judge(const geometry_msgs::PoseStamped& pose, const std::string& sender,
                            const ros::Time& now, double received) const {
  return judge(pose.header, isFinite(pose.pose), sender, now, received);
}

PoseVerdict PoseGate::judge(const std_msgs::Header& header, bool finite, const std::string& sender,
                            const ros::Time& now, double received) const {
  if (!finite) return PoseVerdict::NotFinite;
  const bool silent = received - received_ > silence_;
  if (!silent && sender != sender_) return PoseVerdict::OtherSender;
  const ros::Time stamp = header.stamp;
  if (stamp.isZero()) return PoseVerdict::Accepted;
  if (max_age_ > 0.0 && secondsBetween(stamp, now) > max_age_) return PoseVerdict::Late;
  if (!silent && stamp < last_ && secondsBetween(stamp, last_) <= kClockJump) return PoseVerdict::OutOfOrder;
  return PoseVerdict::Accepted;
}

void PoseGate::take(const std_msgs::Header& header, const std::string& sender, double received) {
  if (!header.stamp.isZero()) last_ = header.stamp;
  received_ = received;
  if (sender != sender_) sender_ = sender;
}

}  // namespace haptic_cloth
