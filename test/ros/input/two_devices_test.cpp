/// The launch file for two devices: each driver moves its probe and feels it in its own axes, its button
/// holds the cloth, and what it holds turns with it.
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <ros/ros.h>
#include <sensor_msgs/Joy.h>

#include <cmath>
#include <mutex>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth {
namespace {

// Places in the axes of the drivers, x right, y up, z to the user (config/devices/touch.yaml). Their origins
// are 20 mm below and 40 mm above the cloth (launch/two_devices.launch, config/scenes/two_fingers.yaml).
const Vec3 kThumbPressed(0.0, 0.0135, 0.0), kIndexPressed(0.0, -0.0335, 0.0);

/// Direction along warp at the corner of the cloth that the fingers pinch, in the newest state.
class CornerListener {
 public:
  explicit CornerListener(ros::NodeHandle& node) {
    subscriber_ = node.subscribe<ClothState>("cloth/state", 1, [this](const ClothState::ConstPtr& state) {
      const std::uint32_t corner = state->columns * state->rows - 1;
      Vec3 at = Vec3::Zero(), before = Vec3::Zero();
      for (std::size_t n = 0; n < state->particles.size(); ++n) {
        const Vec3 place(state->positions[3 * n], state->positions[3 * n + 1], state->positions[3 * n + 2]);
        if (state->particles[n] == corner - 2) at = place;
        if (state->particles[n] == corner - 3) before = place;
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      direction_ = (at - before).normalized();
    });
  }
  Vec3 direction() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return direction_;
  }

 private:
  mutable std::mutex mutex_;
  Vec3 direction_ = Vec3::Zero();
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

TEST(TwoDevices, PinchHoldAndTurnTheCloth) {
  constexpr double kTurn = 0.5;  // [rad]
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ReactionListener left(node, "left/servo_cf"), right(node, "right/servo_cf");
  DiagnosticsListener diagnostics(node);
  CornerListener corner(node);
  ros::Publisher button = node.advertise<sensor_msgs::Joy>("left/button1", 1, true);
  const auto press = [&](int pressed) {
    sensor_msgs::Joy joy;
    joy.buttons = {pressed};
    button.publish(joy);
  };
  TestDevice thumb(node, Vec3::Zero(), "left/measured_cp"), index(node, Vec3::Zero(), "right/measured_cp");
  ASSERT_TRUE(waitFor([&] {
    return diagnostics.value("thumb", "status") == "free" && diagnostics.value("index", "status") == "free";
  }));
  thumb.moveTo(kThumbPressed);
  index.moveTo(kIndexPressed);
  // The thumb is pushed down and the index finger up, with what the coupling of 200 N/m allows.
  EXPECT_TRUE(waitFor([&] { return left.force().y() < -0.1 && right.force().y() > 0.1; }))
      << left.force().transpose() << ", " << right.force().transpose();
  press(1);
  ASSERT_TRUE(waitFor([&] { return diagnostics.value("thumb", "grasp") == "holds cloth"; }));
  EXPECT_NE(diagnostics.value("index", "grasp"), "holds cloth");
  index.moveTo(Vec3::Zero());
  ASSERT_TRUE(waitFor([&] { return right.force().isZero(0.0) && index.arrived(); }));
  // About the driver's y, which is up. The cloth's warp turns with the thumb, but for what bends beside it.
  const Vec3 before = corner.direction();
  thumb.turn(Quat(Eigen::AngleAxisd(kTurn, Vec3::UnitY())));
  const auto turned = [&] {
    const Vec3 now = corner.direction();
    return std::atan2(before.cross(now).z(), before.dot(now));
  };
  EXPECT_TRUE(waitFor([&] { return std::abs(turned() - kTurn) < 0.02; })) << turned() << " rad";
  press(0);
  EXPECT_TRUE(waitFor([&] { return diagnostics.value("thumb", "grasp") == "open"; }));
}

}  // namespace
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_two_devices_test");
  return RUN_ALL_TESTS();
}
