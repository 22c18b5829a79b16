/// Poses of a device that are dropped leave no trace in those that are taken.
#include "ros/input/device_input.h"

#include <gtest/gtest.h>
#include <ros/time.h>
#include <tf2_ros/buffer.h>

#include "ros/support/yaml_parameters.h"

namespace haptic_cloth::device_input_test {
namespace {

/// A device with tf, whose transforms are all missing.
struct UnknownFrames : testing::Test {
  UnknownFrames() { ros::Time::init(); }

  static NodeOptions options() {
    XmlRpc::XmlRpcValue parameters = sceneParameters();
    parameters["device"]["use_tf"] = true;
    return parseNodeOptions(parameters, "test");
  }

  void send(const std::string& frame, double x, double w) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = frame;
    pose.header.stamp = ros::Time::now();
    pose.pose.orientation.x = x;
    pose.pose.orientation.w = w;
    input_.accept(pose, "driver");
  }

  NodeOptions options_ = options();
  tf2_ros::Buffer transforms_;
  SharedState shared_{options_};
  DeviceInput input_{options_, 0, transforms_, shared_};
};

/// A quaternion of zeros stands for the last orientation.
TEST_F(UnknownFrames, LeaveNoOrientation) {
  const std::string known = options_.frame_id;
  send(known, 0.0, 1.0);
  send("nowhere", 1.0, 0.0);
  EXPECT_EQ(input_.counters().unknown_frame, 1u);
  send("nowhere", 0.0, 0.0);
  EXPECT_EQ(input_.counters().bad_quaternion, 0u) << "counts poses that are taken";
  send(known, 0.0, 0.0);
  EXPECT_EQ(input_.counters().bad_quaternion, 1u);
  EXPECT_EQ(shared_.probes[0].pose.read().pose.orientation.w(), 1.0);
}

}  // namespace
}  // namespace haptic_cloth::device_input_test
