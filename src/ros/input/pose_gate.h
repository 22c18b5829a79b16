/// Decides which device poses are accepted.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/time.h>

#include <limits>
#include <string>

namespace haptic_cloth {

enum class PoseVerdict { Accepted, NotFinite, OtherSender, OutOfOrder, Late };

/// Judges poses and forces by content, sender and stamp. A stamp of zero is always accepted.
class PoseGate {
 public:
  /// @param max_age a pose with an older stamp is late [s]; 0: never
  /// @param silence after this time without a pose any sender and any order of stamps is accepted
  /// [s]
  PoseGate(double max_age, double silence) : max_age_(max_age), silence_(silence) {}

  void setTimes(double max_age, double silence) {
    max_age_ = max_age;
    silence_ = silence;
  }

  /// @param sender name of the sending node. The first sender keeps the probe until it is silent,
  /// because two hands would throw the probe back and forth
  /// @param now clock of the stamps
  /// @param received steady clock [s]
  PoseVerdict judge(const geometry_msgs::PoseStamped& pose, const std::string& sender, const ros::Time& now,
                    double received) const;

  /// Judges any message. @param finite whether all its numbers are finite
  PoseVerdict judge(const std_msgs::Header& header, bool finite, const std::string& sender,
                    const ros::Time& now, double received) const;

  /// Records an accepted message. Later messages are compared with it. Call it only if all other
  /// checks passed too.
  void take(const std_msgs::Header& header, const std::string& sender, double received);

  double maxAge() const { return max_age_; }

  /// Sender whose poses are accepted; empty before the first pose.
  const std::string& sender() const { return sender_; }

 private:
  double max_age_, silence_;
  ros::Time last_;  ///< stamp of the last accepted pose
  /// Time of the last accepted pose, steady clock [s].
  double received_ = -std::numeric_limits<double>::infinity();
  std::string sender_;
};

}  // namespace haptic_cloth
