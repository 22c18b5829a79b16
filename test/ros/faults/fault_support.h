/// Parts that the fault tests share: a check of every wrench, a hand as a separate process, the pid
/// of a node.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth {

/// A wrench as received.
struct HeardWrench {
  std::uint32_t number = 0;  ///< the node's count of wrenches: one per tick since its start
  ros::Time stamp;           ///< stamp of the pose it answers
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double received = 0.0;  ///< steady clock [s]
  /// connection on which it came; one per process
  boost::shared_ptr<const ros::M_string> connection;
};

/// Largest wrench that a node may send with this number [N]. Its first wrench is zero. Then the
/// limit rises with the soft start and the force at its rate, by at most five periods of either per
/// tick (HapticLoop).
double strongestAt(std::uint32_t number, const HapticOptions& limits);

/// Findings about a series of wrenches.
struct WrenchFindings {
  long heard = 0;
  /// Numbers that never came, because newer wrenches replaced them in a queue of one.
  long lost = 0;
  long starts = 0;  ///< how often the numbers started again: another process
  long not_finite = 0, too_strong = 0, too_fast = 0;  ///< by force or by torque
  long too_early = 0;                                 ///< starts with more than strongestAt()
  double strongest = 0.0;                             ///< [N]
  double fastest = 0.0;  ///< largest change, divided by the ticks between [N per tick]
};

/// @param limits promised limits. A tick may catch up five periods of the rate limit (HapticLoop),
/// so two neighbours may differ by that much, whatever the machine did in between.
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
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

/// Whether this process is only a hand: first arguments "--hand NAME X Y Z".
bool isHand(int argc, char** argv);

/// Sends poses at 500 Hz, from X Y Z towards the newest point on hand/target (geometry_msgs/Point),
/// until it is killed.
int runHand(int argc, char** argv);

/// Starts this program again as a hand at `start`, in a separate process.
std::unique_ptr<Process> startHand(const std::string& name, const Vec3& start);

/// Process id of a node; -1 if it does not answer.
pid_t pidOf(const std::string& node);

/// Resident memory of a process [MB].
double residentMemory(pid_t pid);

/// Number of files and sockets that a process has open.
int openFiles(pid_t pid);

/// Free: the probe's radius is 10 mm, the cloth of scene.yaml is at 0.10 m.
const Vec3 kAbove(0.0, 0.0, 0.125);
/// The probe's lowest point is 10 mm below the flat cloth, its centre is not. So a hand that finds
/// a new cloth there is still on the side it came from.
const Vec3 kPressed(0.0, 0.0, 0.100);

/// A running node under observation. At the end of each case every wrench must have been valid, and
/// the node must work without any intervention.
class FaultTest : public testing::Test {
 protected:
  FaultTest();
  void TearDown() override;

  /// Waits for wrenches and moves a hand into the cloth until a force is felt.
  void press();
  /// @return whether a force is felt again after the hand is lifted and lowered
  bool recovers();
  /// @return whether the pressing hand feels a force, perhaps after a while: if a busy machine
  /// delays the hand by 50 ms, the force goes to zero and returns without a new press
  bool feels() const;
  double count(const std::string& key) const { return diagnostics_.number("probe", key); }
  /// Waits until `key` of the probe is at least `value`.
  bool reaches(const std::string& key, double value) const;
  /// Waits for diagnostics made after this call.
  void freshDiagnostics() const;
  /// Checks all wrenches so far and adds the findings to the test's results.
  WrenchFindings expectSound();

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  ReactionRecord reaction_;
  DiagnosticsListener diagnostics_;
  std::unique_ptr<TestDevice> hand_;
};

}  // namespace haptic_cloth
