/// What the fault tests share: a check of every single wrench, a hand as a process of its own, a node's pid.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "ros_test_support.h"

namespace haptic_cloth {

/// A wrench as it came.
struct HeardWrench {
  std::uint32_t number = 0;  ///< the node's count of wrenches: one for each tick, from its start
  ros::Time stamp;           ///< of the pose it answers
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double received = 0.0;                              ///< steady clock [s]
  boost::shared_ptr<const ros::M_string> connection;  ///< over which it came: another one for each process
};

/// Most that a node may send as its wrench of this number [N]: its first is zero, then the limit
/// rises as the soft start lets it and the force at its rate, at most five periods' worth of either
/// a tick (HapticLoop).
double strongestAt(std::uint32_t number, const HapticOptions& limits);

/// What was found in a row of wrenches.
struct WrenchFindings {
  long heard = 0;
  long lost = 0;    ///< numbers that never came: newer ones replaced them in a queue of one
  long starts = 0;  ///< how often the numbers began anew: another process
  long not_finite = 0, too_strong = 0, too_fast = 0;  ///< by force or torque
  long too_early = 0;                                 ///< starts with more than strongestAt()
  double strongest = 0.0;                             ///< [N]
  double fastest = 0.0;                               ///< largest change over ticks between [N a tick]
};

/// @param limits what is promised. A tick may catch up five periods' worth of the rate limit (HapticLoop), so
/// that
///   is what two neighbours may differ by, whatever the machine did in between.
WrenchFindings examine(const std::vector<HeardWrench>& wrenches, const HapticOptions& limits);

/// Keeps every wrench.
class ReactionRecord {
 public:
  ReactionRecord(ros::NodeHandle& node, const std::string& topic);
  std::vector<HeardWrench> all() const;
  void clear();
  long count() const { return count_; }
  HeardWrench last() const;
  Vec3 force() const { return last().force; }

 private:
  mutable std::mutex mutex_;
  std::vector<HeardWrench> wrenches_;
  HeardWrench last_;
  std::atomic<long> count_{0};
  ros::Subscriber subscriber_;  ///< last: its callback uses all above
};

/// Whether this process is to be only a hand: "--hand NAME X Y Z" as first arguments.
bool isHand(int argc, char** argv);

/// Sends poses at 500 Hz from there, then towards what comes on hand/target (geometry_msgs/Point), until it
/// is killed.
int runHand(int argc, char** argv);

/// A hand at `start` as a process of its own, of this very program.
std::unique_ptr<Process> startHand(const std::string& name, const Vec3& start);

/// The process of a node; -1 if it does not answer.
pid_t pidOf(const std::string& node);

/// Resident memory of a process [MB].
double residentMemory(pid_t pid);

/// How many files and sockets a process has open.
int openFiles(pid_t pid);

const Vec3 kAbove(0.0, 0.0, 0.125);  ///< free: the probe's radius is 10 mm, the cloth of scene.yaml at 0.10 m
const Vec3 kPressed(0.0, 0.0, 0.100);  ///< its lowest point 10 mm below the flat cloth, its middle not: a
                                       ///< hand that finds a new cloth there is on the side it came from

/// A node that runs, watched. At the end of each case every wrench must have been sound and the node must
/// work without anybody having touched it.
class FaultTest : public testing::Test {
 protected:
  FaultTest();
  void TearDown() override;

  /// Waits for wrenches and takes a hand to the cloth until a force is felt.
  void press();
  /// @return whether a force is felt again after the hand was lifted and lowered
  bool recovers();
  /// @return whether the hand that presses feels a force. It may do so after a while: where a busy machine
  /// holds the hand up for 50 ms the force goes, and comes back without a new press.
  bool feels() const;
  double count(const std::string& key) const { return diagnostics_.number("probe", key); }
  /// Waits until the probe's `key` is at least `value`.
  bool reaches(const std::string& key, double value) const;
  /// Waits for diagnostics made after this call.
  void freshDiagnostics() const;
  /// Checks the wrenches so far and lets the test's results say what was in them.
  WrenchFindings expectSound();

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  ReactionRecord reaction_;
  DiagnosticsListener diagnostics_;
  std::unique_ptr<TestDevice> hand_;
};

}  // namespace haptic_cloth
