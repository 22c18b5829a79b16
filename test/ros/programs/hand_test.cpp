/// The launch file of the demonstration: a simulated hand in a closed loop with the cloth.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <cmath>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth::hand_test {
namespace {

// Values of HandOptions. The damping ratio is 0.73, so the hand overshoots by 4 %.
constexpr double kWill = 0.050, kStiffness = 300.0, kDamping = 8.0;

TEST(Hand, PressesFeelsAndLifts) {
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ReactionListener reaction(node, "probe/reaction");
  std::atomic<double> height{-1.0};
  std::atomic<long> poses{0};
  const ros::Subscriber pose = node.subscribe<geometry_msgs::PoseStamped>(
      "probe/pose", 1000, [&](const geometry_msgs::PoseStamped::ConstPtr& message) {
        height = message->pose.position.z;
        ++poses;
      });
  ASSERT_TRUE(waitFor([&] { return reaction.count() > 0 && poses > 0; }));
  ASSERT_TRUE(waitFor([&] { return reaction.force().z() > 0.2; })) << "the hand felt nothing";
  // The cloth lies on a box of 50 mm, and the probe's radius is 8 mm. The hand aims at 50 mm; the
  // box holds it above, where arm and force balance. The tolerance is the effect of 30 mm/s on the
  // arm's damper.
  double held = 0.0, force = 0.0;
  EXPECT_TRUE(waitFor([&] {
    held = height;
    force = reaction.force().z();
    const double slow = 0.03 * kDamping / kStiffness;
    return force > 0.2 && held < 0.062 && std::abs(held - kWill - force / kStiffness) < slow;
  })) << held
      << " m, " << force << " N";
  double lowest = height;
  ASSERT_TRUE(waitFor([&] {
    lowest = std::min(lowest, height.load());
    return height > 0.12;
  })) << "the hand did not lift";
  // A busy machine may take the force away. Then the arm reaches its target and overshoots by 4 %
  // of the way.
  EXPECT_GT(lowest, kWill - 0.04 * (0.062 - kWill));
  EXPECT_TRUE(waitFor([&] { return reaction.force().isZero(0.0); }));
  EXPECT_TRUE(reaction.finite());

  const long seen_poses = poses, seen_reactions = reaction.count();
  EXPECT_TRUE(waitFor([&] { return poses > seen_poses && reaction.count() > seen_reactions; }))
      << "a node died";
}

}  // namespace
}  // namespace haptic_cloth::hand_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_hand_test");
  return RUN_ALL_TESTS();
}
