/// Two probes, their grasps, a moving table, and the mouse, on the running node. Criteria: the
/// weight of a grasped sheet in the air follows from mass and gravity; a cloth on a table moves
/// with the table; poses come back as they were sent.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <ros/ros.h>
#include <signal.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>
#include <visualization_msgs/InteractiveMarkerInit.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "ros/node/conversions.h"
#include "ros/support/ros_test_support.h"
#include "support/scenes.h"

namespace haptic_cloth::fingers_test {
namespace {

using visualization_msgs::InteractiveMarkerFeedback;

// Values of test/ros/input/fingers.yaml, fingers.test and config/fabrics/linear.yaml.
constexpr double kTable = 0.05, kRadius = 0.010;
constexpr double kWeight = 0.15 * 0.1 * 0.1 * 9.81;  ///< [N]
const Vec3 kRightOffset(0.0, 0.0, 0.02);
const Vec3 kLeftAbove(-0.03, 0.0, 0.08), kLeftPressed(-0.03, 0.0, kTable + kRadius - 0.004);
const Vec3 kRightAbove(0.03, 0.0, 0.08), kRightPressed(0.03, 0.0, kTable + 0.008 - 0.004);

/// Keeps the newest message of a topic.
template <class Message>
class Listener {
 public:
  Listener(ros::NodeHandle& node, const std::string& topic) {
    subscriber_ = node.subscribe<Message>(topic, 10, [this](const boost::shared_ptr<Message const>& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      last_ = *message;
      ++count_;
    });
  }
  Message last() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_;
  }
  long count() const { return count_; }

 private:
  mutable std::mutex mutex_;
  Message last_;
  std::atomic<long> count_{0};
  ros::Subscriber subscriber_;
};

/// Position for the right device's driver. Its origin is 20 mm higher, and its axes are rotated by
/// 90 degrees about z.
Vec3 forRight(const Vec3& position) {
  const Vec3 from = position - kRightOffset;
  return {from.y(), -from.x(), from.z()};
}

class FingersTest : public testing::Test {
 protected:
  FingersTest()
      : spinner_(2),
        left_force_(node_, "left/reaction"),
        right_force_(node_, "right/reaction"),
        state_(node_, "cloth/state"),
        diagnostics_(node_) {
    spinner_.start();
  }
  void SetUp() override {
    ASSERT_TRUE(waitFor([this] { return left_force_.count() > 0 && right_force_.count() > 0; }));
    pause(false);
    std_srvs::Empty empty;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/reset", empty));
  }
  void TearDown() override {
    const long left = left_force_.count(), right = right_force_.count();
    EXPECT_TRUE(waitFor([&] { return left_force_.count() > left && right_force_.count() > right; }));
    EXPECT_TRUE(left_force_.finite() && right_force_.finite());
  }

  void pause(bool paused) {
    std_srvs::SetBool request;
    request.request.data = paused;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", request));
  }
  /// Changes the limit live, like all limits.
  void limitTorque(double most) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.doubles.emplace_back();
    call.request.config.doubles.back().name = "haptics/max_torque";
    call.request.config.doubles.back().value = most;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/set_parameters", call));
  }
  /// @return whether the node accepts it
  bool grasp(const std::string& probe, bool closed) {
    std_srvs::SetBool request;
    request.request.data = closed;
    return ros::service::call("/" + probe + "/set_grasp", request) && request.response.success;
  }
  bool says(const std::string& part, const std::string& key, const std::string& value) {
    return waitFor([&] { return diagnostics_.value(part, key) == value; });
  }
  double height() const {
    const ClothState state = state_.last();
    double sum = 0.0;
    for (std::size_t k = 2; k < state.positions.size(); k += 3) sum += state.positions[k];
    return sum / static_cast<double>(std::max<std::size_t>(state.particles.size(), 1));
  }
  void startLeft() {
    left_ = std::make_unique<TestDevice>(node_, kLeftAbove, "left/pose");
    ASSERT_TRUE(says("left", "status", "free"));
  }
  void holdWithLeft() {
    startLeft();
    left_->moveTo(kLeftPressed);
    ASSERT_TRUE(waitFor([this] { return left_force_.force().z() > 0.1; }));
    ASSERT_TRUE(grasp("left", true));
    ASSERT_TRUE(says("left", "grasp", "holds cloth"));
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  ReactionListener left_force_, right_force_;
  Listener<ClothState> state_;
  DiagnosticsListener diagnostics_;
  std::unique_ptr<TestDevice> left_;
};

TEST_F(FingersTest, EachFeelsWhatItTouches) {
  startLeft();
  TestDevice right(node_, forRight(kRightAbove), "right/pose");
  ASSERT_TRUE(says("right", "status", "free"));
  left_->moveTo(kLeftPressed);
  ASSERT_TRUE(waitFor([this] { return left_force_.force().z() > 0.1; }));
  EXPECT_TRUE(right_force_.force().isZero(0.0));
  right.moveTo(forRight(kRightPressed));
  ASSERT_TRUE(waitFor([this] { return right_force_.force().z() > 0.1; }));
  left_->moveTo(kLeftAbove);
  EXPECT_TRUE(waitFor([this] { return left_force_.force().isZero(0.0); }));
  EXPECT_TRUE(waitFor([this] { return right_force_.force().z() > 0.1; })) << "without another press";
}

TEST_F(FingersTest, TheCapsuleTurnsWithItsDevice) {
  Listener<geometry_msgs::PoseStamped> proxy(node_, "right/proxy");
  const Quat turned(Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()));
  const Quat expected = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ())) * turned;
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("right/pose", 1);
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "world";
  pose.pose = toPose(forRight(kRightAbove), turned);
  EXPECT_TRUE(waitFor([&] {
    pose.header.stamp = ros::Time::now();
    publisher.publish(pose);
    const Pose at = toPose(proxy.last().pose);
    return at.orientation.angularDistance(expected) < 1e-6 && (at.position - kRightAbove).norm() < 1e-3;
  })) << toPose(proxy.last().pose).orientation.coeffs().transpose();
}

/// The capsule lies across an edge of the cloth and is pressed 4 mm below the table's top. Only the
/// half above the cloth is touched.
TEST_F(FingersTest, TheCapsuleFeelsTheTorqueOfTheClothsEdge) {
  constexpr double kEdge = 0.05, kHalfLength = 0.01, kCapsuleRadius = 0.008;
  const Vec3 over(kEdge, 0.0, 0.08), pressed(kEdge, 0.0, kTable + kCapsuleRadius - 0.004);
  const Quat along_x = lyingAlong(Vec3::UnitX());
  const Quat axes(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()));  // rotation of the driver's axes
  TestDevice right(node_, forRight(over), "right/pose");
  right.turn(axes.conjugate() * along_x);
  ASSERT_TRUE(says("right", "status", "free"));
  EXPECT_TRUE(right_force_.torque().isZero(0.0));
  right.moveTo(forRight(pressed));
  ASSERT_TRUE(waitFor([&] { return right.arrived(); }));
  // An upward force F at the distance a towards -x is a torque a F about y, which is the driver's x
  // axis. Both values are of one wrench, because a busy machine may take the force away for a
  // while.
  Vec3 arm = Vec3::Zero();
  EXPECT_TRUE(waitFor([&] {
    const geometry_msgs::Wrench wrench = right_force_.last().wrench;
    if (wrench.force.z < 0.5) return false;
    arm = Vec3(wrench.torque.x, wrench.torque.y, wrench.torque.z) / wrench.force.z;
    const bool touched = arm.x() > 0.1 * kHalfLength && arm.x() < kHalfLength + kCapsuleRadius;
    // Everything is symmetric in the other direction.
    return touched && std::abs(arm.y()) < 0.2 * arm.x();
  })) << arm.transpose();
  EXPECT_TRUE(waitFor([&] { return diagnostics_.number("right", "torque [N m]") > 0.0; }));

  limitTorque(0.0);
  EXPECT_TRUE(
      waitFor([this] { return right_force_.torque().isZero(0.0) && right_force_.force().z() > 0.5; }));
  limitTorque(0.1);
  EXPECT_TRUE(waitFor([this] { return right_force_.torque().x() > 1e-3; }));
  pause(true);
  EXPECT_TRUE(waitFor([this] { return right_force_.force().isZero(0.0); }));
  EXPECT_TRUE(waitFor([this] { return right_force_.torque().isZero(0.0); }));
}

TEST_F(FingersTest, AGraspLiftsTheClothAndItsWeightIsFelt) {
  holdWithLeft();
  left_->moveTo(kLeftAbove + Vec3(0.0, 0.0, 0.12));
  // The tolerance of 5 % covers a small swing.
  EXPECT_TRUE(waitFor([&] {
    return left_->arrived() && std::abs(left_force_.force().z() + kWeight) < 0.05 * kWeight;
  })) << left_force_.force().transpose();
  EXPECT_GT(height(), kTable + 0.03);
  EXPECT_TRUE(grasp("left", false));
  EXPECT_TRUE(waitFor([this] { return height() < kTable + 0.03; })) << "it must fall";
  EXPECT_TRUE(waitFor([this] { return left_force_.force().isZero(0.0); }));
}

TEST_F(FingersTest, TheTopicGraspsToo) {
  startLeft();
  ros::Publisher publisher = node_.advertise<std_msgs::Bool>("left/grasp", 1);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  std_msgs::Bool closed;
  closed.data = true;
  publisher.publish(closed);
  EXPECT_TRUE(says("left", "grasp", "closed"));
  closed.data = false;
  publisher.publish(closed);
  EXPECT_TRUE(says("left", "grasp", "open"));
}

TEST_F(FingersTest, PauseSilenceAndResetOpenTheGrasp) {
  EXPECT_FALSE(grasp("right", true)) << "without poses there is nobody to grasp";
  holdWithLeft();
  pause(true);
  EXPECT_TRUE(says("left", "grasp", "open"));
  EXPECT_FALSE(grasp("left", true)) << "paused";
  pause(false);
  ASSERT_TRUE(grasp("left", true));
  EXPECT_TRUE(says("left", "grasp", "holds cloth"));
  left_->silence();
  EXPECT_TRUE(says("left", "grasp", "open"));
  left_->moveTo(kLeftAbove);
  left_->resume();
  ASSERT_TRUE(waitFor([this] { return left_->arrived(); }));
  ASSERT_TRUE(waitFor([this] { return grasp("left", true); }));
  EXPECT_TRUE(says("left", "grasp", "closed")) << diagnostics_.value("left", "grasp");
  std_srvs::Empty empty;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/reset", empty));
  EXPECT_TRUE(says("left", "grasp", "open"));
}

TEST_F(FingersTest, TheTableTakesTheClothAlong) {
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("obstacles/table/pose", 1);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  ASSERT_TRUE(waitFor([&] { return diagnostics_.number("obstacle table", "received") >= 0.0; }));
  const double received = diagnostics_.number("obstacle table", "received");
  double sent = 0.0;
  geometry_msgs::PoseStamped pose;
  const auto send = [&](const geometry_msgs::PoseStamped& message) {
    publisher.publish(message);
    ++sent;
    ASSERT_TRUE(
        waitFor([&] { return diagnostics_.number("obstacle table", "received") == received + sent; }));
  };
  const double not_finite = diagnostics_.number("obstacle table", "dropped: not finite");
  const double unknown = diagnostics_.number("obstacle table", "dropped: unknown frame");
  pose.pose = toPose(Vec3(0.0, 0.0, std::numeric_limits<double>::quiet_NaN()));
  send(pose);
  pose.pose = toPose(Vec3(0.0, 0.0, 0.5));
  pose.header.frame_id = "nowhere";
  send(pose);
  EXPECT_EQ(diagnostics_.number("obstacle table", "dropped: not finite"), not_finite + 1);
  EXPECT_EQ(diagnostics_.number("obstacle table", "dropped: unknown frame"), unknown + 1);
  EXPECT_LT(height(), kTable + 0.01) << "neither moved the table";

  pose.header.frame_id = "world";
  pose.pose = toPose(Vec3(0.0, 0.0, 0.025 + 0.04));
  send(pose);
  // The sheet is 0.5 mm thick and may still be slightly in the air.
  EXPECT_TRUE(waitFor([&] { return std::abs(height() - kTable - 0.04) < 2e-3; })) << height();
}

/// Runs mouse_hand as a process, driven as rviz would drive it.
TEST_F(FingersTest, TheMouseDragsAndGrasps) {
  Listener<geometry_msgs::PoseStamped> left_pose(node_, "left/pose"), right_proxy(node_, "right/proxy");
  Listener<visualization_msgs::InteractiveMarkerInit> handles(node_, "probes/update_full");
  ros::Publisher publisher = node_.advertise<InteractiveMarkerFeedback>("probes/feedback", 10);
  Process mouse({programDirectory() + "/mouse_hand", "__name:=mouse_hand"});
  ASSERT_TRUE(waitFor([&] {
    return left_pose.count() > 100 && handles.count() > 0 && publisher.getNumSubscribers() > 0;
  })) << mouse.output();
  ASSERT_EQ(handles.last().markers.size(), 2u);
  EXPECT_EQ(handles.last().markers[0].menu_entries.size(), 2u);
  ASSERT_TRUE(says("right", "status", "free")) << "waits over the cloth";

  InteractiveMarkerFeedback feedback;
  feedback.header.frame_id = "world";
  feedback.client_id = "test";
  feedback.event_type = InteractiveMarkerFeedback::POSE_UPDATE;
  feedback.marker_name = "right";
  feedback.pose = toPose(kRightAbove);
  publisher.publish(feedback);
  EXPECT_TRUE(waitFor([&] { return (toVec3(right_proxy.last().pose.position) - kRightAbove).norm() < 1e-3; }))
      << toVec3(right_proxy.last().pose.position).transpose();

  feedback.event_type = InteractiveMarkerFeedback::MENU_SELECT;
  for (const auto& [entry, state] : {std::pair(1u, "closed"), std::pair(2u, "open")}) {
    feedback.menu_entry_id = entry;
    publisher.publish(feedback);
    EXPECT_TRUE(says("right", "grasp", state));
    EXPECT_EQ(diagnostics_.value("left", "grasp"), "open");
  }
  mouse.signal(SIGINT);
  EXPECT_EQ(mouse.wait(), 0) << mouse.output();
}

}  // namespace
}  // namespace haptic_cloth::fingers_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_fingers_test");
  return RUN_ALL_TESTS();
}
