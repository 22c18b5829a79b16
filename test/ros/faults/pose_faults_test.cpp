/// Faulty poses: too many, too few, in bursts, out of order, not finite, from two hands. Criteria
/// of every case (docs/architecture.md): each wrench is finite, within 3.3 N, and changes per tick
/// by no more than five periods of 200 N/s; the fault is counted in the diagnostics; good poses
/// beside bad ones keep their force; afterwards a press is felt again without any action on the
/// node.
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "fault_support.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth::pose_faults_test {
namespace {

using geometry_msgs::PoseStamped;

constexpr int kBad = 200;  ///< poses of each bad kind sent beside good ones

class PoseFaultTest : public FaultTest {
 protected:
  // The queue is long, so that only the node drops poses.
  PoseFaultTest() : bad_(node_.advertise<PoseStamped>("probe/pose", 1000)) {}

  static PoseStamped pressed() {
    PoseStamped pose;
    pose.header.stamp = ros::Time::now();
    pose.header.frame_id = "world";
    pose.pose = toPose(kPressed);
    return pose;
  }

  /// Sends `count` poses of a pressing hand at `rate` [Hz], each changed by `spoil`.
  void send(int count, double rate, const std::function<void(int, PoseStamped&)>& spoil) {
    double due = steadyNow();
    for (int k = 0; k < count; ++k) {
      PoseStamped pose = pressed();
      spoil(k, pose);
      bad_.publish(pose);
      due += 1.0 / rate;
      sleepUntil(due);
    }
  }

  /// Checks all wrenches since reaction_ was cleared. A busy machine may stop the hand for a
  /// moment, so not all of them need a force.
  void expectFeltThroughout() {
    const std::vector<HeardWrench> heard = reaction_.all();
    const auto felt = std::count_if(heard.begin(), heard.end(),
                                    [](const HeardWrench& wrench) { return wrench.force.norm() > 0.05; });
    EXPECT_GT(felt, 0.8 * static_cast<double>(heard.size())) << "the fault took the force away";
    RecordProperty("felt", std::to_string(static_cast<double>(felt) / static_cast<double>(heard.size())));
  }

  ros::Publisher bad_;
};

TEST_F(PoseFaultTest, BadPosesBesideGoodOnesAreCountedAndNotFelt) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), most = std::numeric_limits<double>::max();
  const double not_finite[] = {nan, most * 2.0, -most * 2.0};
  // Finite, but not their squares or difference quotients.
  const double far[] = {1e8, -1e155, 1e300, -most};
  const double not_unit[] = {0.0, 2.0, 1e-200, 1e200};
  const char* const unknown[] = {"nowhere", "world/", "a frame with spaces"};
  // Each kind of fault has its counter.
  const std::vector<std::pair<std::string, std::function<void(int, PoseStamped&)>>> faults = {
      {"dropped: not finite",
       [&](int k, PoseStamped& pose) {
         (k % 2 == 0 ? pose.pose.position.z : pose.pose.orientation.w) = not_finite[k % 3];
       }},
      {"dropped: too far", [&](int k, PoseStamped& pose) { pose.pose.position.x = far[k % 4]; }},
      {"taken: bad quaternion", [&](int k, PoseStamped& pose) { pose.pose.orientation.w = not_unit[k % 4]; }},
      {"dropped: unknown frame", [&](int k, PoseStamped& pose) { pose.header.frame_id = unknown[k % 3]; }},
      {"dropped: out of order",
       [](int k, PoseStamped& pose) { pose.header.stamp -= ros::Duration(0.02 + 1e-4 * k); }},
      {"dropped: late", [](int, PoseStamped& pose) { pose.header.stamp -= ros::Duration(0.5); }}};
  press();
  freshDiagnostics();
  std::vector<double> before;
  for (const auto& fault : faults) before.push_back(count(fault.first));
  reaction_.clear();
  const int kinds = static_cast<int>(faults.size());
  send(kBad * kinds, 500.0, [&](int k, PoseStamped& pose) {
    faults[static_cast<std::size_t>(k % kinds)].second(k / kinds, pose);
  });
  for (std::size_t k = 0; k < faults.size(); ++k) {
    const std::string& key = faults[k].first;
    // A busy node takes the newest pose and misses the others.
    EXPECT_TRUE(reaches(key, before[k] + 0.5 * kBad)) << key;
    RecordProperty(key, static_cast<int>(count(key) - before[k]));
  }
  expectFeltThroughout();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, OneStampAheadSilencesTheDeviceForNoLongerThanTheWatchdog) {
  press();
  double dropped = 0.0;
  ASSERT_TRUE(waitFor([&] {  // repeat if a newer pose replaced this one
    freshDiagnostics();
    const double before = count("dropped: out of order");
    send(1, 500.0, [](int, PoseStamped& pose) { pose.header.stamp += ros::Duration(0.9); });
    freshDiagnostics();
    dropped = count("dropped: out of order") - before;
    return dropped > 0.0;
  }));
  // 0.05 s at 500 Hz are 25 poses; without the time limit the stamp ahead would block 450. The
  // bound is half of that.
  EXPECT_LT(dropped, 225.0);
  RecordProperty("dropped", static_cast<int>(dropped));
  EXPECT_TRUE(recovers());
}

/// ros::Time has 32 bits of seconds; sums and differences beyond that throw.
TEST_F(PoseFaultTest, StampsAtTheEndOfTimeDoNotEndTheNode) {
  const ros::Time last(std::numeric_limits<std::uint32_t>::max(), 0);
  ros::Publisher transforms = node_.advertise<tf2_msgs::TFMessage>("/tf", 100);
  press();
  ASSERT_TRUE(waitFor([&] { return transforms.getNumSubscribers() > 0; }));
  reaction_.clear();
  send(kBad, 500.0, [&](int k, PoseStamped& pose) {
    if (k % 2 == 0) pose.header.stamp = last;
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.frame_id = "world";
    message.transforms[0].header.stamp = ros::Time(last.sec - static_cast<std::uint32_t>(k % 4), 5);
    message.transforms[0].child_frame_id = "device";
    message.transforms[0].transform.rotation.w = 1.0;
    transforms.publish(message);
  });
  expectFeltThroughout();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, FiveKilohertz) {
  press();
  hand_->silence();
  freshDiagnostics();
  const double before = count("received");
  PoseStamped last;
  send(10000, 5000.0, [&](int, PoseStamped& pose) { last = pose; });
  EXPECT_TRUE(waitFor([&] { return reaction_.last().stamp == last.header.stamp; }))
      << "the newest is not used";
  freshDiagnostics();
  RecordProperty("received", static_cast<int>(count("received") - before));
  hand_->resume();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, OneHertzIsAFaultEachTime) {
  press();
  hand_->silence();
  ASSERT_TRUE(waitFor([&] { return reaction_.force().isZero(0.0); }));
  freshDiagnostics();
  const double before = count("force off: poses stopped");
  reaction_.clear();
  send(4, 1.0, [](int, PoseStamped&) {});
  EXPECT_TRUE(reaches("force off: poses stopped", before + 3));
  // A pose is valid for 50 ms, and the tick that finds it catches up at most five periods. So the
  // soft start of 500 ms rises for at most that time, however late the ticks are.
  const HapticOptions options;
  const double counts = options.pose_timeout + 5.0 / options.rate;
  EXPECT_LE(examine(reaction_.all(), options).strongest,
            options.max_force * counts / options.soft_start * (1.0 + 1e-9));
  EXPECT_TRUE(reaction_.force().isZero(0.0));
  hand_->resume();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, BurstsWithSilenceBetween) {
  press();
  hand_->silence();
  freshDiagnostics();
  const double before = count("force off: poses stopped");
  PoseStamped last;
  for (int burst = 0; burst < 20; ++burst) {
    send(50, 1e5, [&](int k, PoseStamped& pose) {
      pose.pose.position.z -= 1e-4 * k;  // a hand that moved while nothing was sent
      last = pose;
    });
    sleepUntil(steadyNow() + 0.12);
  }
  EXPECT_TRUE(waitFor([&] { return reaction_.last().stamp == last.header.stamp; }))
      << "the newest is not used";
  EXPECT_TRUE(reaches("force off: poses stopped", before + 10));
  hand_->resume();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, ADeviceThatJumpsAMetreFeelsNothingThere) {
  // Poses like those of a tracker that loses its marker: from the press to a place 1 m below the
  // cloth for 0.3 s and back into the cloth, repeatedly. The force is off 20 ms after a jump
  // (ramp_time). For a busy machine, 80 % of the wrenches that answer a pose there suffice. The
  // force stays off until the probe has been clear of the cloth.
  press();
  hand_->silence();
  reaction_.clear();
  std::set<ros::Time> away;
  send(1500, 500.0, [&](int k, PoseStamped& pose) {
    if (k % 300 < 150) return;
    pose.pose.position.z -= 1.0;
    away.insert(pose.header.stamp);
  });
  long there = 0, off = 0;
  for (const HeardWrench& wrench : reaction_.all()) {
    if (away.count(wrench.stamp) == 0) continue;
    ++there;
    off += wrench.force.isZero(0.0);
  }
  EXPECT_GT(there, 0);
  EXPECT_GT(static_cast<double>(off), 0.8 * static_cast<double>(there));
  RecordProperty("off", std::to_string(static_cast<double>(off) / static_cast<double>(there)));
  hand_->resume();
  EXPECT_TRUE(recovers());
}

TEST_F(PoseFaultTest, ASecondHandWaitsUntilTheFirstIsSilent) {
  press();
  freshDiagnostics();
  const double before = count("dropped: other sender");
  reaction_.clear();
  const std::unique_ptr<Process> second = startHand("second_hand", Vec3(0.0, 0.0, 1.0));
  ASSERT_TRUE(reaches("dropped: other sender", before + 200));
  expectFeltThroughout();
  // The first hand falls silent, so the second, a metre above the cloth, takes over.
  hand_->silence();
  EXPECT_TRUE(waitFor([this] { return diagnostics_.value("probe", "status") == "free"; }));
  hand_->resume();
  second->signal(SIGKILL);
  second->wait();
  EXPECT_TRUE(recovers());
}

}  // namespace
}  // namespace haptic_cloth::pose_faults_test

int main(int argc, char** argv) {
  if (haptic_cloth::isHand(argc, argv)) return haptic_cloth::runHand(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_pose_faults_test");
  return RUN_ALL_TESTS();
}
