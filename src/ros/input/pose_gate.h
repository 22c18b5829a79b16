/// Which device poses are taken.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/time.h>

#include <string>

namespace haptic_cloth {

enum class PoseVerdict { Accepted, NotFinite, OtherSender, OutOfOrder, Late };

/// Judges poses, and forces, by content, sender and stamp. A zero stamp says nothing and passes.
class PoseGate {
 public:
  /// @param max_age an older stamp is late [s]; 0: never
  /// @param silence after which there is nothing to be in order with: any stamp is good, from any sender [s]
  PoseGate(double max_age, double silence) : max_age_(max_age), silence_(silence) {}

  void setTimes(double max_age, double silence) {
    max_age_ = max_age;
    silence_ = silence;
  }

  /// @param sender name of the node that sent it. Who was first keeps the probe until it is silent: two hands
  ///   would throw it to and fro
  /// @param now clock of the stamps
  /// @param received steady clock [s]
  PoseVerdict judge(const geometry_msgs::PoseStamped& pose, const std::string& sender, const ros::Time& now,
                    double received) const;

  /// The same for any message. @param finite whether its numbers are
  PoseVerdict judge(const std_msgs::Header& header, bool finite, const std::string& sender,
                    const ros::Time& now, double received) const;

  /// A pose that was good in every other respect, too, is what the next ones are compared with.
  void take(const std_msgs::Header& header, const std::string& sender, double received);

  double maxAge() const { return max_age_; }

  /// Whose poses are taken; empty before the first.
  const std::string& sender() const { return sender_; }

 private:
  double max_age_, silence_;
  ros::Time last_;           ///< stamp of the last pose taken
  double received_ = -1e30;  ///< of the last pose taken, steady clock [s]
  std::string sender_;
};

}  // namespace haptic_cloth
