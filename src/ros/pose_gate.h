/// Which device poses are taken.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/time.h>

namespace haptic_cloth {

enum class PoseVerdict { Accepted, NotFinite, OutOfOrder, Late };

/// Judges poses, and forces, by content and stamp. A zero stamp says nothing and passes.
class PoseGate {
 public:
  /// @param max_age an older stamp is late [s]; 0: never
  explicit PoseGate(double max_age) : max_age_(max_age) {}

  void setMaxAge(double max_age) { max_age_ = max_age; }

  /// @param now clock of the stamps
  PoseVerdict judge(const geometry_msgs::PoseStamped& pose, const ros::Time& now);

  /// The same for any message. @param finite whether its numbers are
  PoseVerdict judge(const std_msgs::Header& header, bool finite, const ros::Time& now);

 private:
  double max_age_;
  ros::Time last_;  ///< stamp of the last accepted pose
};

}  // namespace haptic_cloth
