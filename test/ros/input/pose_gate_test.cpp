/// Messages that the gate accepts: by content, sender and stamp.
#include "ros/input/pose_gate.h"

#include <gtest/gtest.h>

#include <limits>

#include "ros/node/conversions.h"

namespace haptic_cloth::pose_gate_test {
namespace {

geometry_msgs::PoseStamped poseAt(double stamp) {
  geometry_msgs::PoseStamped pose;
  pose.pose = toPose(Vec3::Zero());
  pose.header.stamp = ros::Time(stamp);
  return pose;
}

/// Feeds poses one after the other and returns the verdicts of the gate.
class PoseGateTest : public testing::Test {
 protected:
  PoseVerdict take(double stamp, double now, double received, const std::string& sender = "/device") {
    const PoseVerdict verdict = gate_.judge(poseAt(stamp), sender, ros::Time(now), received);
    if (verdict == PoseVerdict::Accepted) gate_.take(poseAt(stamp).header, sender, received);
    return verdict;
  }
  PoseGate gate_{0.2, 0.05};
};

TEST_F(PoseGateTest, Stamps) {
  EXPECT_EQ(take(99.9, 100.0, 1.00), PoseVerdict::Accepted);
  EXPECT_EQ(take(99.9, 100.0, 1.01), PoseVerdict::Accepted);
  EXPECT_EQ(take(99.85, 100.0, 1.02), PoseVerdict::OutOfOrder);
  EXPECT_EQ(take(99.7, 100.0, 1.03), PoseVerdict::Late);
  EXPECT_EQ(take(0.0, 100.0, 1.04), PoseVerdict::Accepted);
  EXPECT_EQ(take(99.95, 100.0, 1.05), PoseVerdict::Accepted);
  // The clock was set back by 50 s.
  EXPECT_EQ(take(50.0, 50.0, 1.06), PoseVerdict::Accepted);
  EXPECT_EQ(take(49.9, 50.0, 1.07), PoseVerdict::OutOfOrder);
}

TEST_F(PoseGateTest, AfterSilenceAnyStampIsANewStart) {
  // One stamp half a second ahead must not block the device for half a second.
  EXPECT_EQ(take(100.5, 100.0, 1.00), PoseVerdict::Accepted);
  EXPECT_EQ(take(100.01, 100.01, 1.01), PoseVerdict::OutOfOrder);
  EXPECT_EQ(take(100.06, 100.06, 1.06), PoseVerdict::Accepted);
  EXPECT_EQ(take(100.07, 100.07, 1.07), PoseVerdict::Accepted);
}

TEST_F(PoseGateTest, StampsMayBeAnyTimeApart) {
  // ros::Time holds 32 bits of seconds; its difference throws from 2^31 on.
  constexpr double kLast = 4294967295.0;
  EXPECT_EQ(take(kLast, 100.0, 1.00), PoseVerdict::Accepted);
  EXPECT_EQ(take(100.0, 100.0, 1.01), PoseVerdict::Accepted) << "the clock was set back";
  EXPECT_EQ(take(100.0, kLast, 1.02), PoseVerdict::Late);
  EXPECT_EQ(take(kLast, kLast, 1.03), PoseVerdict::Accepted);
}

TEST_F(PoseGateTest, TakesTheFirstPoseWithAnyTimes) {
  gate_.setTimes(0.2, 1e300);
  EXPECT_EQ(take(100.0, 100.0, 1.00), PoseVerdict::Accepted);
}

TEST_F(PoseGateTest, TheFirstSenderKeepsTheProbeWhileItSends) {
  EXPECT_EQ(take(0.0, 100.0, 1.00, "/one"), PoseVerdict::Accepted);
  EXPECT_EQ(take(0.0, 100.0, 1.01, "/two"), PoseVerdict::OtherSender);
  EXPECT_EQ(take(0.0, 100.0, 1.02, "/one"), PoseVerdict::Accepted);
  // /one falls silent, or sends only poses that are refused.
  EXPECT_EQ(take(99.0, 100.0, 1.06, "/one"), PoseVerdict::Late);
  EXPECT_EQ(take(0.0, 100.0, 1.08, "/two"), PoseVerdict::Accepted);
  EXPECT_EQ(take(0.0, 100.0, 1.09, "/one"), PoseVerdict::OtherSender);
}

TEST(PoseGate, NoAgeLimit) {
  const PoseGate gate(0.0, 0.05);
  EXPECT_EQ(gate.judge(poseAt(10.0), "", ros::Time(1e9), 0.0), PoseVerdict::Accepted);
}

TEST(PoseGate, NotFinite) {
  const PoseGate gate(0.2, 0.05);
  geometry_msgs::PoseStamped pose = poseAt(0.0);
  pose.pose.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(gate.judge(pose, "", ros::Time(1.0), 0.0), PoseVerdict::NotFinite);
}

}  // namespace
}  // namespace haptic_cloth::pose_gate_test
