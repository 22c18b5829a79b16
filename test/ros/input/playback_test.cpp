/// A recorded hand, played with the standard tools.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <unistd.h>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth::playback_test {
namespace {

TEST(Playback, ARecordedHandFeelsTheCloth) {
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ReactionListener reaction(node, "probe/reaction");
  DiagnosticsListener diagnostics(node);
  ASSERT_TRUE(waitFor([&] { return reaction.count() > 0; })) << "the node does not run";

  const std::string folder = std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/input/";
  const std::string bag = "/tmp/haptic_cloth_motion_" + std::to_string(getpid()) + ".bag";
  Process convert({folder + "csv_to_bag.py", folder + "hand_motion.csv", bag});
  ASSERT_EQ(convert.wait(), 0) << convert.output();

  // Twice, because the second start sets the stamps back by two seconds.
  double greatest = 0.0;
  for (int run = 0; run < 2; ++run) {
    Process play({"rosbag", "play", "--quiet", "--wait-for-subscribers", bag});
    double greatest_now = 0.0;
    ASSERT_TRUE(waitFor([&] {
      greatest_now = std::max(greatest_now, reaction.force().z());
      return !play.running();
    }));
    EXPECT_EQ(play.wait(), 0) << play.output();
    EXPECT_GT(greatest_now, 0.1) << "run " << run;
    greatest = std::max(greatest, greatest_now);
  }
  unlink(bag.c_str());
  EXPECT_LE(greatest, 3.3 + 1e-9);
  EXPECT_TRUE(reaction.finite());
  EXPECT_TRUE(waitFor([&] { return reaction.force().isZero(0.0); }))
      << "after the last pose the force must go";
  EXPECT_TRUE(waitFor([&] { return diagnostics.number("probe", "received") > 500; }));
  EXPECT_EQ(diagnostics.number("probe", "dropped"), 0.0);
}

}  // namespace
}  // namespace haptic_cloth::playback_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_playback_test");
  return RUN_ALL_TESTS();
}
