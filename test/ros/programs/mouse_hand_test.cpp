/// The hand without a device: how it follows the mouse, and the places of its handles.
#include "ros/programs/mouse_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ros/node/conversions.h"

namespace haptic_cloth::mouse_hand_test {
namespace {

/// A first-order lag: after the time t the remaining distance is e^(-t/T) of the jump, for any
/// number of steps.
TEST(SmoothedPose, AJumpDiesAway) {
  const Pose target{Vec3(0.1, 0.0, 0.0), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()))};
  for (const int steps : {1, 7, 100}) {
    SmoothedPose hand(Pose(), 0.03);
    Pose pose;
    for (int k = 0; k < steps; ++k) pose = hand.step(target, 0.06 / steps);
    EXPECT_NEAR(0.1 - pose.position.x(), 0.1 * std::exp(-2.0), 1e-12);
    EXPECT_NEAR(pose.orientation.angularDistance(target.orientation), std::exp(-2.0), 1e-9);
  }
}

TEST(MouseHand, WaitsAtTheStartOfThePathOrOverTheClothApart) {
  Scene scene;
  scene.probes.resize(2);
  scene.probes[1].name = "index";
  const Vec3 first = waitingPose(scene, 0).position, second = waitingPose(scene, 1).position;
  EXPECT_GT(first.z(), scene.cloth.pose.position.z() + scene.probes[0].radius);
  EXPECT_GT((second - first).norm(), scene.probes[0].radius + scene.probes[1].radius);
  scene.probes[1].path = {{0.0, Vec3(1, 2, 3)}, {1.0, Vec3(4, 5, 6)}};
  EXPECT_EQ(waitingPose(scene, 1).position, Vec3(1, 2, 3));
}

TEST(MouseHand, AHandleOfACapsuleTurnsThatOfASphereDoesNot) {
  using visualization_msgs::InteractiveMarkerControl;
  ProbeOptions probe;
  const Pose pose{Vec3(1, 2, 3), Quat(Eigen::AngleAxisd(0.4, Vec3::UnitX()))};
  const auto turns = [&] {
    const auto handle = probeHandle(probe, pose, "world");
    EXPECT_EQ(handle.name, probe.name);
    EXPECT_EQ(toVec3(handle.pose.position), pose.position);
    for (const auto& control : handle.controls) {
      EXPECT_TRUE(isUnit(control.orientation)) << control.name;
      for (const auto& marker : control.markers) EXPECT_GE(marker.scale.x, 2.0 * probe.radius);
    }
    return std::count_if(handle.controls.begin(), handle.controls.end(), [](const auto& control) {
      return control.interaction_mode == InteractiveMarkerControl::ROTATE_AXIS;
    });
  };
  EXPECT_EQ(turns(), 0);
  probe.length = 0.03;
  EXPECT_EQ(turns(), 3);
}

}  // namespace
}  // namespace haptic_cloth::mouse_hand_test
