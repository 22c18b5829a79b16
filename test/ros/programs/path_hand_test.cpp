/// A hand that follows the path of the scene again and again.
#include <gtest/gtest.h>
#include <ros/ros.h>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth {
namespace {

/// The reset before each round opens the grasp, so the hand has to close it after that.
TEST(PathHand, AGraspFromTheStartHoldsInEveryRound) {
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(1);
  spinner.start();
  DiagnosticsListener diagnostics(node);
  const auto becomes = [&](const std::string& grasp) {
    return waitFor([&] { return diagnostics.value("probe", "grasp") == grasp; });
  };
  for (int round = 1; round <= 2; ++round) {
    EXPECT_TRUE(becomes("holds cloth")) << "round " << round;
    EXPECT_TRUE(becomes("open")) << "round " << round;
  }
}

}  // namespace
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_path_hand_test");
  return RUN_ALL_TESTS();
}
