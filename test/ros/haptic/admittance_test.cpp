/// An admittance device on the running node: a measured force moves the commanded pose. Criteria:
/// in free space a force F leads to the speed F/b, and before that the motion follows the law of
/// the damped mass; on the cloth the tool rests where hand and coupling balance, F/k behind the
/// proxy; a lost force, a pause and a reset bring it to rest.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

#include <cmath>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::admittance_test {
namespace {

// Values of admittance.test and scene.yaml.
constexpr double kMass = 0.2, kDamping = 4.0, kStiffness = 400.0;
/// Longest time that one tick catches up: five periods at 1 kHz (AdmittanceLoop) [s].
constexpr double kMostOfATick = 5e-3;
const Vec3 kOffset(0.0, 0.0, 0.02), kStart(0.0, 0.0, 0.15);

/// Rotates from the driver's axes into the cloth's, and back.
Vec3 turned(const Vec3& v) { return {-v.y(), v.x(), v.z()}; }
Vec3 turnedBack(const Vec3& v) { return {v.y(), -v.x(), v.z()}; }

/// A force sensor at 500 Hz.
class TestSensor {
 public:
  explicit TestSensor(ros::NodeHandle& node)
      : publisher_(node.advertise<geometry_msgs::WrenchStamped>("probe/force", 1)),
        thread_([this] { run(); }) {}
  ~TestSensor() {
    stop_ = true;
    thread_.join();
  }
  /// @param force in the cloth's axes [N]
  void set(const Vec3& force) {
    const std::lock_guard<std::mutex> lock(mutex_);
    force_ = turnedBack(force);
  }
  void silence(bool silent) { silent_ = silent; }

 private:
  void run() {
    while (!stop_) {
      sleepUntil(steadyNow() + 2e-3);
      if (silent_) continue;
      const std::lock_guard<std::mutex> lock(mutex_);
      publisher_.publish(toWrench({force_, Vec3::Zero()}, ros::Time::now(), "world"));
    }
  }
  ros::Publisher publisher_;
  std::mutex mutex_;
  Vec3 force_ = Vec3::Zero();
  std::atomic<bool> silent_{false}, stop_{false};
  std::thread thread_;
};

struct Command {
  std::uint32_t number;  ///< the node's count: one per tick
  double time;           ///< time of its tick, from its stamp [s]
  Vec3 position;         ///< in the cloth's frame [m]
};

/// Records every message on probe/command, placed as the driver would place it.
class CommandListener {
 public:
  explicit CommandListener(ros::NodeHandle& node) {
    subscriber_ = node.subscribe<geometry_msgs::PoseStamped>(
        "probe/command", 1000,
        [this](const geometry_msgs::PoseStamped::ConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          commands_.push_back({message->header.seq, message->header.stamp.toSec(),
                               kOffset + turned(toVec3(message->pose.position))});
          frame_ = message->header.frame_id;
        },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  }
  std::vector<Command> commands() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return commands_;
  }
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return commands_.size();
  }
  Vec3 position() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return commands_.empty() ? Vec3::Constant(NAN) : commands_.back().position;
  }
  std::string frame() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return frame_;
  }
  /// Whether the tool has not moved at all in the last commands.
  bool rests() const {
    const std::vector<Command> all = commands();
    constexpr std::size_t kMany = 50;
    if (all.size() < kMany) return false;
    for (std::size_t k = all.size() - kMany; k < all.size(); ++k) {
      if (all[k].position != all.back().position) return false;
    }
    return true;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Command> commands_;
  std::string frame_;
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

class AdmittanceTest : public testing::Test {
 protected:
  AdmittanceTest() : spinner_(2), command_(node_), reaction_(node_, "probe/reaction"), diagnostics_(node_) {
    spinner_.start();
  }
  void SetUp() override {
    ASSERT_TRUE(waitFor([this] { return reaction_.count() > 0; }));
  }
  void TearDown() override {
    const long seen = reaction_.count();
    EXPECT_TRUE(waitFor([&] { return reaction_.count() > seen; })) << "the node died";
    EXPECT_TRUE(reaction_.finite());
  }
  bool says(const std::string& status) {
    return waitFor([&] { return diagnostics_.value("probe", "status") == status; });
  }
  void push(const Vec3& force) {
    if (!sensor_) sensor_ = std::make_unique<TestSensor>(node_);
    sensor_->set(force);
  }
  /// Moves the tool to within a millimetre of a place in free space, like a hand with 20 N/m.
  void bringTo(const Vec3& place) {
    ASSERT_TRUE(waitFor([&] {
      const Vec3 way = place - command_.position();
      push(way.allFinite() ? Vec3(20.0 * way) : Vec3(Vec3::Zero()));
      return way.norm() < 1e-3;
    }));
    push(Vec3::Zero());
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  CommandListener command_;
  ReactionListener reaction_;
  DiagnosticsListener diagnostics_;
  std::unique_ptr<TestSensor> sensor_;
};

/// This test runs first, while the tool has not started.
TEST_F(AdmittanceTest, ACommandComesWithTheFirstForceAndWhereTheDeviceIs) {
  ASSERT_TRUE(says("no force"));
  {
    const TestDevice lost(node_, Vec3::Constant(NAN));
    ASSERT_TRUE(says("no pose"));
    EXPECT_NE(diagnostics_.value("probe", "poses dropped: not finite"), "0");
    push(Vec3::Zero());
    ASSERT_TRUE(waitFor([&] { return std::stoi("0" + diagnostics_.value("probe", "received")) > 200; }));
    EXPECT_EQ(command_.count(), 0u) << "nobody knows where the device is";
  }
  sensor_.reset();
  const long then = diagnostics_.count();
  ASSERT_TRUE(waitFor([&] { return diagnostics_.count() > then + 2; }));  // longer than force_timeout
  const Vec3 device(0.01, 0.02, 0.16);
  TestDevice pose(node_, turnedBack(device - kOffset));
  ASSERT_TRUE(waitFor([&] { return reaction_.count() > 200; }));
  EXPECT_EQ(command_.count(), 0u) << "nobody has pushed";
  ASSERT_TRUE(waitFor([&] { return diagnostics_.count() > 3; }));  // the pose has long arrived
  push(Vec3::Zero());
  ASSERT_TRUE(waitFor([&] { return command_.count() > 0; }));
  EXPECT_NEAR((command_.commands().front().position - device).norm(), 0.0, 1e-9);
  EXPECT_EQ(command_.frame(), "world");
  EXPECT_TRUE(says("free"));
}

/// Time for which the tool has moved between two commands, from their stamps.
struct Moved {
  double least = 0.0, most = 0.0;  ///< they differ only if commands of late ticks were lost [s]
};

Moved timeMoved(const std::vector<Command>& commands, std::size_t first, std::size_t last) {
  Moved moved;
  for (std::size_t k = first + 1; k <= last; ++k) {
    const double passed = commands[k].time - commands[k - 1].time;
    const double ticks = commands[k].number - commands[k - 1].number;
    moved.least += std::min(passed, kMostOfATick);
    moved.most += std::min(passed, ticks * kMostOfATick);
  }
  return moved;
}

/// A force F leads to the speed F/b. Late ticks lose distance, so only the time that the ticks
/// caught up counts. The tool is measured from 8 τ on, where it lacks e^-8 = 3e-4 of that speed.
/// Stamps and ticks use two clocks, read one after the other. So at either end of the distance they
/// may differ by one tick.
TEST_F(AdmittanceTest, AForceMovesTheCommandByTheLaw) {
  bringTo(kStart);
  push(Vec3::Zero());
  ASSERT_TRUE(waitFor([this] { return command_.rests(); }));
  const Vec3 force(0.16, -0.12, 0.0);  // 0.2 N: 50 mm/s
  const double speed = force.norm() / kDamping, tau = kMass / kDamping;
  const Vec3 from = command_.position();
  const std::size_t first = command_.count();
  push(force);
  ASSERT_TRUE(waitFor([&] { return (command_.position() - from).norm() > 0.06; }));
  push(Vec3::Zero());
  const std::vector<Command> all = command_.commands();
  std::size_t begin = first, end = 0;
  while (begin < all.size() && (all[begin].position - from).norm() < 8.0 * tau * speed) ++begin;
  for (end = begin; end + 1 < all.size() && (all[end + 1].position - from).norm() < 0.06;) ++end;
  ASSERT_LT(begin, end);
  const Vec3 way = all[end].position - all[begin].position;
  ASSERT_GT(way.norm(), 0.03);
  const Moved moved = timeMoved(all, begin, end);
  const double share = std::exp(-8.0), ends = 2e-3;
  EXPECT_GT(way.norm(), speed * (moved.least * (1.0 - share) - ends));
  EXPECT_LT(way.norm(), speed * (moved.most + ends));
  EXPECT_LT(way.normalized().cross(force.normalized()).norm(), 1e-6);
  RecordProperty("way_over_law", std::to_string(way.norm() / (speed * moved.least)));
  RecordProperty("lost_way_s", std::to_string(all[end].time - all[begin].time - moved.least));
  // After the end of the force the tool coasts by v τ.
  ASSERT_TRUE(waitFor([this] { return command_.rests(); }));
}

TEST_F(AdmittanceTest, RestsOnTheClothWhereTheForcesBalance) {
  bringTo(Vec3(0.0, 0.0, 0.125));
  std::mutex mutex;
  Vec3 proxy = Vec3::Zero();
  const ros::Subscriber listener = node_.subscribe<geometry_msgs::PoseStamped>(
      "probe/proxy", 1, [&](const geometry_msgs::PoseStamped::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        proxy = toVec3(message->pose.position);
      });
  constexpr double kPress = 0.4;
  push(Vec3(0, 0, -kPress));
  const auto stretch = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return proxy.z() - command_.position().z();
  };
  const auto near = [](double value, double wanted, double share) {
    return std::abs(value - wanted) < share * wanted;
  };
  EXPECT_TRUE(waitFor([&] { return near(turned(reaction_.force()).z(), kPress, 0.02); }))
      << reaction_.force().transpose();
  EXPECT_TRUE(waitFor([&] { return near(stretch(), kPress / kStiffness, 0.05); })) << stretch();
  ASSERT_TRUE(says("contact"));

  // The hand lets go and the cloth pushes the tool out. A lost force stops the tool.
  push(Vec3(0, 0, 0.2));
  EXPECT_TRUE(waitFor([&] { return command_.position().z() > 0.12; }));
  sensor_->silence(true);
  EXPECT_TRUE(waitFor([this] { return command_.rests(); }));
  EXPECT_TRUE(says("force stale"));
  const Vec3 there = command_.position();
  sensor_->silence(false);
  EXPECT_TRUE(waitFor([&] { return command_.position().z() > there.z() + 0.01; })) << "it goes on";
}

TEST_F(AdmittanceTest, APauseBringsItToRest) {
  bringTo(kStart);
  push(Vec3(0.2, 0, 0));
  ASSERT_TRUE(waitFor([this] { return command_.position().x() > 0.02; }));
  std_srvs::SetBool request;
  request.request.data = true;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", request));
  EXPECT_TRUE(waitFor([this] { return command_.rests(); }));
  EXPECT_TRUE(says("paused"));
  const Vec3 there = command_.position();
  request.request.data = false;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", request));
  EXPECT_TRUE(waitFor([&] { return command_.position().x() > there.x() + 0.01; }));
  std_srvs::Empty empty;
  EXPECT_TRUE(ros::service::call("/haptic_cloth/reset", empty));
  push(Vec3::Zero());
  EXPECT_TRUE(waitFor([this] { return command_.rests(); }));
}

/// With twice the force scale the hand feels twice the force of the cloth, so where hand and cloth
/// balance, half of the hand's force acts on the probe.
TEST_F(AdmittanceTest, BalancesTheHandWithAnotherForceScale) {
  const auto scale = [](double value) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.doubles.resize(1);
    call.request.config.doubles[0].name = "devices/probe/force_scale";
    call.request.config.doubles[0].value = value;
    return ros::service::call("/haptic_cloth/set_parameters", call);
  };
  bringTo(Vec3(0.0, 0.0, 0.125));
  ASSERT_TRUE(scale(2.0));
  constexpr double kPress = 0.4;
  push(Vec3(0, 0, -kPress));
  const auto balances = [&] { return std::abs(turned(reaction_.force()).z() - kPress) < 0.02 * kPress; };
  EXPECT_TRUE(waitFor([&] { return balances() && command_.rests(); })) << reaction_.force().transpose();
  EXPECT_TRUE(balances()) << reaction_.force().transpose();
  EXPECT_TRUE(says("contact"));
  ASSERT_TRUE(scale(1.0));
  push(Vec3(0, 0, 0.2));
  EXPECT_TRUE(waitFor([&] { return command_.position().z() > 0.12; }));
}

}  // namespace
}  // namespace haptic_cloth::admittance_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_admittance_test");
  return RUN_ALL_TESTS();
}
