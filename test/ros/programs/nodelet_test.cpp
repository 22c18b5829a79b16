/// The nodelet: loads, is felt, leaves no force when it is unloaded, and refuses bad parameters.
#include <gtest/gtest.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <ros/ros.h>
#include <signal.h>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth::nodelet_test {
namespace {

bool load(const std::string& name, const std::string& manager = "/manager") {
  nodelet::NodeletLoad request;
  request.request.name = name;
  request.request.type = "haptic_cloth/HapticCloth";
  return ros::service::call(manager + "/load_nodelet", request) && request.response.success;
}

bool unload(const std::string& name) {
  nodelet::NodeletUnload request;
  request.request.name = name;
  return ros::service::call("/manager/unload_nodelet", request) && request.response.success;
}

TEST(Nodelet, LoadsIsFeltAndUnloadsWithoutForce) {
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ASSERT_TRUE(ros::service::waitForService("/manager/load_nodelet", ros::Duration(kPatience)));
  ReactionListener reaction(node, "probe/reaction");
  TestDevice device(node, Vec3(0.0, 0.0, 0.125));
  ASSERT_TRUE(load("/cloth"));
  const Vec3 above(0.0, 0.0, 0.125), pressed(0.0, 0.0, 0.100);
  const DiagnosticsListener diagnostics(node);  // a press starts with the probe clear of the cloth
  ASSERT_TRUE(waitFor([&] { return diagnostics.value("probe", "status") == "free"; }));
  EXPECT_TRUE(diagnostics.heard("cloth: probe")) << "its own name, not the manager's";
  device.moveTo(pressed);
  ASSERT_TRUE(waitFor([&] { return reaction.force().z() > 0.1; }));
  std::string scene;
  ASSERT_TRUE(ros::param::get("/cloth/scene_file", scene));
  ros::param::set("/twin/scene_file", scene);
  EXPECT_FALSE(load("/twin")) << "two on the same topics would both answer the hand";
  ASSERT_TRUE(waitFor([&] { return reaction.force().z() > 0.1; })) << "the first one goes on";
  ASSERT_TRUE(unload("/cloth"));
  EXPECT_TRUE(waitFor([&] { return reaction.force() == Vec3::Zero(); }));

  ros::param::set("/bad/scene_file", "/nowhere.yaml");
  EXPECT_FALSE(load("/bad")) << "without a scene there is nothing to run";
  ASSERT_TRUE(load("/cloth")) << "the manager must have survived";
  device.moveTo(above);
  ASSERT_TRUE(waitFor([&] { return device.arrived(); }));
  ASSERT_TRUE(waitFor([&] { return diagnostics.value("probe", "status") == "free"; }));
  device.moveTo(pressed);
  EXPECT_TRUE(waitFor([&] { return reaction.force().z() > 0.1; }));
}

/// A separate manager that gets a signal while its nodelet is felt.
class ManagerEnds : public testing::TestWithParam<int> {};

TEST_P(ManagerEnds, WithoutForce) {
  const std::string manager = "/manager_" + std::to_string(GetParam()), space = "/stage";
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  Process process({"rosrun", "nodelet", "nodelet", "manager", "__name:=" + manager.substr(1)});
  std::string scene;
  ASSERT_TRUE(ros::param::get("/cloth/scene_file", scene));
  ros::param::set(space + "/cloth/scene_file", scene);
  ASSERT_TRUE(ros::service::waitForService(manager + "/load_nodelet", ros::Duration(kPatience)));
  ReactionListener reaction(node, space + "/probe/reaction");
  TestDevice device(node, Vec3(0.0, 0.0, 0.125), space + "/probe/pose");
  const DiagnosticsListener diagnostics(node);
  ASSERT_TRUE(load(space + "/cloth", manager)) << process.output();
  ASSERT_TRUE(waitFor([&] { return diagnostics.value("probe", "status") == "free"; }));
  device.moveTo(Vec3(0.0, 0.0, 0.100));
  ASSERT_TRUE(waitFor([&] { return reaction.force().z() > 0.1; }));
  process.signal(GetParam());
  EXPECT_EQ(process.wait(), GetParam() == SIGINT ? 0 : 128 + GetParam()) << process.output();
  EXPECT_TRUE(waitFor([&] { return reaction.force() == Vec3::Zero(); })) << "the force was left on";
  ros::param::del(space);
}

INSTANTIATE_TEST_SUITE_P(Signal, ManagerEnds, testing::Values(SIGINT, SIGTERM, SIGQUIT));

TEST(Nodelet, SaysWhyItDoesNotLoad) {
  // The manager reports only that loading failed.
  Process alone({"rosrun", "nodelet", "nodelet", "standalone", "haptic_cloth/HapticCloth", "__name:=alone",
                 "_scene_file:=/nowhere.yaml"});
  EXPECT_NE(alone.wait(), 0);
  EXPECT_NE(alone.output().find("/nowhere.yaml: cannot be read"), std::string::npos) << alone.output();
  ros::param::del("/alone");
}

}  // namespace
}  // namespace haptic_cloth::nodelet_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_nodelet_test");
  return RUN_ALL_TESTS();
}
