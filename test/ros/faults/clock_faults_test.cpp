/// A simulated clock that jumps back and forth, stands still or never starts. Watchdog and haptic
/// thread use another clock, so a jump may cost no more than the poses stamped before it.
/// Criterion: as in pose_faults_test; the force returns without any action on the node or the
/// device.
#include <geometry_msgs/TransformStamped.h>
#include <haptic_cloth/ClothState.h>
#include <rosgraph_msgs/Clock.h>
#include <std_srvs/Empty.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "fault_support.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth::clock_faults_test {
namespace {

/// Publishes /clock at 500 Hz.
class TestClock {
 public:
  TestClock(ros::NodeHandle& node, double start)
      : publisher_(node.advertise<rosgraph_msgs::Clock>("/clock", 10)),
        time_(start),
        thread_([this] { run(); }) {}
  ~TestClock() {
    stop_ = true;
    thread_.join();
  }
  void jump(double seconds) { jump_ = seconds; }
  void setRate(double rate) { rate_ = rate; }

 private:
  void run() {
    constexpr double kPeriod = 2e-3;
    while (!stop_) {
      sleepUntil(steadyNow() + kPeriod);
      time_ += rate_ * kPeriod + jump_.exchange(0.0);
      rosgraph_msgs::Clock message;
      message.clock = ros::Time(time_);
      publisher_.publish(message);
    }
  }
  ros::Publisher publisher_;
  double time_;  ///< [s]
  std::atomic<double> jump_{0.0}, rate_{1.0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// The part of a node that path_hand uses: its parameters, the reset and the cloth's time. It has
/// its own namespace.
class PathStage {
 public:
  PathStage() : node_("stage") {
    node_.setParam("haptic_cloth/cloth/fabric", "linear");
    XmlRpc::XmlRpcValue path;  // from x = 0 to 1 m in a second
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 4; ++column)
        path[row][column] = column < 2 ? static_cast<double>(row) : 0.0;
    }
    node_.setParam("haptic_cloth/probe/path", path);
    reset_ = node_.advertiseService("haptic_cloth/reset", &PathStage::reset, this);
    state_ = node_.advertise<ClothState>("cloth/state", 1);
    pose_ = node_.subscribe<geometry_msgs::PoseStamped>(
        "probe/pose", 1,
        [this](const geometry_msgs::PoseStamped::ConstPtr& pose) { place_ = pose->pose.position.x; });
    hand_ = std::make_unique<Process>(
        std::vector<std::string>{programDirectory() + "/path_hand", "__ns:=stage", "__name:=path_hand"});
  }
  ~PathStage() { node_.deleteParam("haptic_cloth"); }

  /// Publishes the cloth's time.
  void tell(double time) {
    ClothState state;
    state.header.stamp = ros::Time::now();
    state.time = time;
    state_.publish(state);
  }
  /// Publishes this time until the hand reaches the place. @return whether it does
  bool comesTo(double place, double time) {
    return waitFor([&] {
      tell(time);
      return std::abs(place_ - place) < 1e-9;
    });
  }
  bool wasReset() const { return reset_done_; }
  double place() const { return place_; }
  std::string said() const { return hand_->output(); }

 private:
  bool reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
    reset_done_ = true;
    return true;
  }
  ros::NodeHandle node_;
  ros::ServiceServer reset_;
  ros::Publisher state_;
  std::atomic<double> place_{-1.0};
  std::atomic<bool> reset_done_{false};
  ros::Subscriber pose_;
  std::unique_ptr<Process> hand_;
};

class ClockFaultTest : public FaultTest {
 protected:
  /// @return whether the pressing hand, which does not move, feels a force again
  bool comesBack() {
    sleepUntil(steadyNow() + 0.3);  // if the fault is felt, it is felt at once
    return feels();
  }
};

// This test needs a node without any clock, so it must be the first.
TEST_F(ClockFaultTest, WithoutAnyClockThereIsForceAllTheSame) { press(); }

TEST_F(ClockFaultTest, WithoutAnyClockAPathIsFollowedAllTheSame) {
  PathStage stage;
  // The cloth's time before the reset, which would be the end of the path, is not the time of the
  // path.
  ASSERT_TRUE(waitFor([&] {
    stage.tell(5.0);
    return stage.wasReset();
  })) << stage.said();
  EXPECT_EQ(stage.place(), 0.0);
  EXPECT_TRUE(stage.comesTo(0.25, 0.25)) << stage.place();
  EXPECT_TRUE(stage.comesTo(1.0, 1.5)) << stage.place();
}

TEST_F(ClockFaultTest, APathGoesOnWhenTheClockJumpsBack) {
  TestClock clock(node_, 1000.0);
  ASSERT_TRUE(waitFor([] { return ros::Time::now().toSec() > 999.0; }));
  PathStage stage;
  ASSERT_TRUE(waitFor([&] { return stage.wasReset(); })) << stage.said();
  clock.jump(-500.0);
  ASSERT_TRUE(waitFor([] { return ros::Time::now().toSec() < 600.0; }));
  EXPECT_TRUE(stage.comesTo(0.25, 0.25)) << stage.place();
  EXPECT_TRUE(stage.comesTo(1.0, 1.5)) << stage.place();
}

TEST_F(ClockFaultTest, JumpsToAndFro) {
  TestClock clock(node_, 1000.0);
  ASSERT_TRUE(waitFor([] { return ros::Time::now().toSec() > 999.0; }));
  press();
  for (const double jump : {0.1, -0.1, 0.9, -0.9, 100.0, -100.0, 1e6, -1e6, -900.0}) {
    SCOPED_TRACE(jump);
    clock.jump(jump);
    EXPECT_TRUE(comesBack());
    EXPECT_TRUE(waitFor([&] {  // the stamps continue with the new clock
      return std::abs((reaction_.last().stamp - ros::Time::now()).toSec()) < 0.05;
    }));
  }
  // Each jump back by less than a second costs 50 ms of poses at 500 Hz.
  EXPECT_TRUE(reaches("dropped: out of order", 10));
  RecordProperty("dropped", static_cast<int>(count("dropped")));
  RecordProperty("stops", static_cast<int>(count("force off: poses stopped")));
  EXPECT_TRUE(recovers());
}

TEST_F(ClockFaultTest, AClockThatStandsStillChangesNothing) {
  TestClock clock(node_, 2000.0);
  press();
  freshDiagnostics();
  const double dropped = count("dropped");
  clock.setRate(0.0);
  sleepUntil(steadyNow() + 1.0);
  EXPECT_TRUE(feels());
  clock.setRate(1.0);
  freshDiagnostics();
  EXPECT_EQ(count("dropped"), dropped);
  EXPECT_TRUE(recovers());
}

TEST_F(ClockFaultTest, AFixedFrameOutlivesAJumpBack) {
  TestClock clock(node_, 3000.0);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "world";
  transform.child_frame_id = "device_base";
  transform.transform.rotation.w = 1.0;
  broadcaster.sendTransform(transform);
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("probe/pose", 1);
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "device_base";
  pose.pose = toPose(kAbove);
  const auto taken = [&] {
    pose.header.stamp = ros::Time::now();
    publisher.publish(pose);
    sleepUntil(steadyNow() + 0.01);
    return reaction_.last().stamp == pose.header.stamp;
  };
  EXPECT_TRUE(waitFor(taken));
  clock.jump(-500.0);
  ASSERT_TRUE(waitFor([] { return ros::Time::now().toSec() < 2600.0; }));
  EXPECT_TRUE(waitFor(taken)) << "the jump took the frame away";
}

}  // namespace
}  // namespace haptic_cloth::clock_faults_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_clock_faults_test");
  return RUN_ALL_TESTS();
}
