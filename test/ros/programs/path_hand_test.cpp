/// A hand that follows the path of the scene again and again.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <ros/ros.h>
#include <signal.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "ros/node/steady_clock.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::path_hand_test {
namespace {

/// The reset before each round opens the grasp, so the hand has to close it after that. So does a pause.
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
    if (round == 1) {
      const auto pause = [](bool paused) {
        std_srvs::SetBool request;
        request.request.data = paused;
        return ros::service::call("/haptic_cloth/pause", request);
      };
      EXPECT_TRUE(pause(true));
      EXPECT_TRUE(becomes("open"));
      EXPECT_TRUE(pause(false));
      EXPECT_TRUE(becomes("holds cloth")) << "the pause opened it";
    }
    EXPECT_TRUE(becomes("open")) << "round " << round;
  }
}

/// After a reset by others the hand goes back to where its path is at that time of the cloth: in the first
/// 0.2 s above 0.12 m. The next round of the path_hand itself begins after 5 s.
TEST(PathHand, AResetByOthersTakesItBack) {
  ros::NodeHandle node;
  std::atomic<double> cloth_time{0.0}, height{0.0};
  std::atomic<int> resets{0};
  std::atomic<bool> began_again{false};
  int before = 1000;  // resets before that of this test
  const ros::Subscriber states = node.subscribe<haptic_cloth::ClothState>(
      "cloth/state", 1000, [&](const haptic_cloth::ClothState::ConstPtr& state) {
        resets += state->time < cloth_time;
        cloth_time = state->time;
      });
  const ros::Subscriber poses = node.subscribe<geometry_msgs::PoseStamped>(
      "probe/pose", 1000, [&](const geometry_msgs::PoseStamped::ConstPtr& pose) {
        height = pose->pose.position.z;
        if (resets > before && cloth_time < 1.0 && height > 0.12) began_again = true;
      });
  const auto spinUntil = [](const std::function<bool()>& condition) {
    return waitFor([&] {
      ros::spinOnce();
      return condition();
    });
  };
  ASSERT_TRUE(spinUntil([&] { return height == 0.105 && cloth_time > 0.5 && cloth_time < 2.0; }))
      << "the path's lowest point, from 0.5 to 3.5 s";
  before = resets;
  std_srvs::Empty empty;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/reset", empty));
  ASSERT_TRUE(spinUntil([&] { return resets > before && cloth_time > 1.0; }));
  EXPECT_TRUE(began_again);
  EXPECT_TRUE(spinUntil([&] { return height == 0.105; }));
}

/// On the way to its start the hand would press on cloth, so it leaves the scene: it is silent for longer
/// than `probe_timeout`, here 5 s.
TEST(PathHand, LeavesTheSceneBeforeItStartsAgain) {
  ros::NodeHandle node;
  double heard = 0.0, silence = 0.0;
  const ros::Subscriber poses = node.subscribe<geometry_msgs::PoseStamped>(
      "probe/pose", 1000, [&](const geometry_msgs::PoseStamped::ConstPtr&) {
        const double now = steadyNow();
        if (heard > 0.0) silence = std::max(silence, now - heard);
        heard = now;
      });
  EXPECT_TRUE(waitFor([&] {
    ros::spinOnce();
    return silence > 5.0;
  }));
}

/// Tells whether a node publishes or subscribes to a topic other than that of its log.
bool isAtWork(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return false;
  for (const int kind : {0, 1}) {
    for (int k = 0; k < state[kind].size(); ++k) {
      XmlRpc::XmlRpcValue &topic = state[kind][k][0], &nodes = state[kind][k][1];
      for (int n = 0; n < nodes.size(); ++n) {
        if (nodes[n] == XmlRpc::XmlRpcValue(node) && !(topic == XmlRpc::XmlRpcValue("/rosout"))) return true;
      }
    }
  }
  return false;
}

/// The ROS master forgets a program that is asked to end.
TEST(Programs, SignOffWhenTheyAreTerminated) {
  for (const std::string program : {"monitor", "hand", "mouse_hand", "path_hand"}) {
    std::vector<std::string> command{programDirectory() + "/" + program, "__name:=ending"};
    if (program != "hand") command.push_back("_node:=/haptic_cloth");
    Process process(command);
    const auto known = [] {
      ros::V_string nodes;
      ros::master::getNodes(nodes);
      return std::find(nodes.begin(), nodes.end(), "/ending") != nodes.end();
    };
    ASSERT_TRUE(waitFor([] { return isAtWork("/ending"); })) << program << process.output();
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(), 0) << program << process.output();
    EXPECT_TRUE(waitFor([&] { return !known(); })) << program;
    ros::param::del("/ending");
  }
}

}  // namespace
}  // namespace haptic_cloth::path_hand_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_path_hand_test");
  return RUN_ALL_TESTS();
}
