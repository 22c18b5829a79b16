/// Options changed by the service of dynamic_reconfigure while a hand presses on the cloth.
/// Criteria: whatever is changed, every wrench is finite and differs from the one before by no more
/// than max_force_rate allows in the longest time that the loop catches up (5 ticks); an accepted
/// value takes effect; a refused one changes nothing and is named.
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/ros.h>
#include <stdlib.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "ros/options/reconfigure_messages.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::live_test {
namespace {

const Vec3 kAbove(0.0, 0.0, 0.125);
const Vec3 kPressed(0.0, 0.0, 0.100);  ///< the probe's lowest point 10 mm below the flat cloth
constexpr double kForceRate = 40.0;    ///< from live.test [N/s]
constexpr double kLateTicks = 5.0;     ///< ticks that the loop may catch up at once

/// Measures the changes between all wrenches of a node.
class StepListener {
 public:
  StepListener(ros::NodeHandle& node, const std::string& topic) {
    subscriber_ = node.subscribe<geometry_msgs::WrenchStamped>(
        topic, 10000, [this](const geometry_msgs::WrenchStamped::ConstPtr& message) { take(*message); },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  }
  /// Largest change from one wrench to the next, relative to what is allowed at `rate_` ticks per
  /// second.
  double worst() const { return worst_; }
  long count() const { return count_; }
  bool finite() const { return finite_; }
  /// @param rate lowest rate since the last call [Hz]
  void expectRate(double rate) { rate_ = rate; }
  Vec3 force() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return force_;
  }

 private:
  void take(const geometry_msgs::WrenchStamped& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto& f = message.wrench.force;
    const Vec3 force(f.x, f.y, f.z);
    if (!force.allFinite()) finite_ = false;
    if (count_ > 0) {
      // Wrenches lost on the way are counted as ticks.
      const double ticks = static_cast<double>(message.header.seq - seq_);
      worst_ = std::max(worst_.load(), (force - force_).norm() / (ticks * kLateTicks * kForceRate / rate_));
    }
    force_ = force;
    seq_ = message.header.seq;
    ++count_;
  }

  ros::Subscriber subscriber_;
  mutable std::mutex mutex_;
  Vec3 force_ = Vec3::Zero();
  std::uint32_t seq_ = 0;
  std::atomic<double> rate_{1000.0}, worst_{0.0};
  std::atomic<long> count_{0};
  std::atomic<bool> finite_{true};
};

class LiveTest : public testing::Test {
 protected:
  LiveTest() : spinner_(2), steps_(node_, "probe/reaction"), diagnostics_(node_) { spinner_.start(); }

  void SetUp() override {
    ASSERT_TRUE(waitFor([this] { return steps_.count() > 0; })) << "the node does not run";
    start_ = set({});
    device_ = std::make_unique<TestDevice>(node_, kAbove);
    ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
    device_->moveTo(kPressed);
    ASSERT_TRUE(waitFor([&] { return device_->arrived() && steps_.force().z() > 0.1; })) << "nothing felt";
    settle();
  }
  void TearDown() override {
    set(start_);
    device_->moveTo(kAbove);
    EXPECT_TRUE(waitFor([&] { return device_->arrived() && steps_.force().isZero(0.0); })) << "the node died";
    EXPECT_TRUE(steps_.finite());
    EXPECT_LE(steps_.worst(), 1.0);
    EXPECT_GT(steps_.worst(), 0.0);
  }

  /// Requests a change. @return the values after it
  LiveValues set(const LiveValues& values) {
    dynamic_reconfigure::Reconfigure call;
    for (const auto& [name, value] : values) {
      if (const bool* flag = std::get_if<bool>(&value)) {
        call.request.config.bools.emplace_back();
        call.request.config.bools.back().name = name;
        call.request.config.bools.back().value = *flag;
      } else if (const int* whole = std::get_if<int>(&value)) {
        call.request.config.ints.emplace_back();
        call.request.config.ints.back().name = name;
        call.request.config.ints.back().value = *whole;
      } else if (const double* number = std::get_if<double>(&value)) {
        call.request.config.doubles.emplace_back();
        call.request.config.doubles.back().name = name;
        call.request.config.doubles.back().value = *number;
      } else {
        call.request.config.strs.emplace_back();
        call.request.config.strs.back().name = name;
        call.request.config.strs.back().value = std::get<std::string>(value);
      }
    }
    EXPECT_TRUE(ros::service::call("/haptic_cloth/set_parameters", call));
    return toValues(call.response.config);
  }
  void accept(const LiveValues& values) {
    const LiveValues answer = set(values);
    for (const auto& [name, value] : values) EXPECT_EQ(answer.at(name), value) << name;
  }

  /// Waits until the force changes by at most 2 % in 300 ticks.
  void settle() {
    ASSERT_TRUE(waitFor([this] {
      const Vec3 before = steps_.force();
      const long seen = steps_.count();
      waitFor([&] { return steps_.count() > seen + 300; });
      return before.norm() > 0.05 && (steps_.force() - before).norm() <= 0.02 * before.norm();
    })) << "the force does not settle";
  }
  /// Settled force after a change.
  double forceWith(const LiveValues& values) {
    accept(values);
    const long seen = steps_.count();
    EXPECT_TRUE(waitFor([&] { return steps_.count() > seen + 300; }));  // past gain_ramp
    settle();
    return steps_.force().norm();
  }
  bool becomes(const std::string& part, const std::string& key, const std::function<bool(double)>& good) {
    return waitFor([&] { return good(diagnostics_.number(part, key)); });
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  StepListener steps_;
  DiagnosticsListener diagnostics_;
  LiveValues start_;
  std::unique_ptr<TestDevice> device_;
};

TEST_F(LiveTest, GainsActAndComeWithoutSteps) {
  const double start = steps_.force().norm();
  // Cloth and coupling are springs in series: a coupling four times as stiff presses the cloth
  // harder.
  const double stiff = forceWith({{"probe/coupling_stiffness", 1600.0}});
  EXPECT_GT(stiff, 1.1 * start);
  const double scaled = forceWith({{"devices/probe/force_scale", 2.0}});
  EXPECT_NEAR(scaled, std::min(2.0 * stiff, 3.3), 0.05 * scaled);
  EXPECT_NEAR(forceWith({{"haptics/max_force", 0.5 * stiff}}), 0.5 * stiff, 1e-9);
  // All values change at once and without a ramp; the limit of the force's rate still holds.
  const double back = forceWith({{"gain_ramp", 0.0},
                                 {"haptics/max_force", 3.3},
                                 {"devices/probe/force_scale", 1.0},
                                 {"probe/coupling_stiffness", 400.0},
                                 {"probe/coupling_damping", 0.5}});
  EXPECT_NEAR(back, start, 0.05 * start);
  accept({{"haptics/passivity/damping", 0.0},
          {"haptics/passivity/store", 0.01},
          {"haptics/soft_start", 0.1},
          {"haptics/ramp_time", 0.05}});
  EXPECT_NEAR(forceWith({}), start, 0.05 * start);
}

TEST_F(LiveTest, AStateHoldsTheGainsThatWereAskedFor) {
  // The gain moves for the whole test: no two steps have the same gain.
  accept({{"gain_ramp", 1000.0}, {"probe/coupling_stiffness", 900.0}});
  char folder[] = "/tmp/haptic_cloth_test_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::string file = std::string(folder) + "/ramp.state";
  SaveState save;
  save.request.file = file;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/save_state", save));
  EXPECT_TRUE(save.response.success) << save.response.message;
  const long seen = steps_.count();
  EXPECT_TRUE(waitFor([&] { return steps_.count() > seen + 100; })) << "the gain moves on";
  LoadState load;
  load.request.file = file;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/load_state", load));
  EXPECT_TRUE(load.response.success) << load.response.message;
  // The state does not fit a node with another requested value, and the message names that value.
  accept({{"probe/coupling_stiffness", 900.0000001}});
  ASSERT_TRUE(ros::service::call("/haptic_cloth/load_state", load));
  EXPECT_FALSE(load.response.success);
  EXPECT_NE(load.response.message.find("coupling_stiffness = 900: the scene here has 900.0000001"),
            std::string::npos)
      << load.response.message;
  std::filesystem::remove_all(folder);
}

TEST_F(LiveTest, TheSolverWorksHarderOrLess) {
  const double press = steps_.force().norm();
  bool up = false;
  // The hand moves, so every step is a new problem.
  const auto iterationsBecome = [&](const std::function<bool(double)>& good) {
    return waitFor([&] {
      if (device_->arrived()) {
        device_->moveTo(up ? kPressed : Vec3(kPressed + Vec3(0.0, 0.0, 0.005)));
        up = !up;
      }
      return good(diagnostics_.number("solver", "iterations per step"));
    });
  };
  accept({{"solver/tolerance", 1e-9}, {"solver/max_iterations", 100}, {"solver/sleep_speed", 0.0}});
  EXPECT_TRUE(iterationsBecome([](double n) { return n > 15.0; }));
  accept({{"solver/max_iterations", 1}});
  // A step is solved at most three times, each with four checks of sleeping particles.
  EXPECT_TRUE(iterationsBecome([](double n) { return n > 0.0 && n <= 12.0; }));
  accept({{"solver/tolerance", 0.01}, {"solver/max_iterations", 200}, {"air_damping", 5.0}});
  device_->moveTo(kPressed);
  ASSERT_TRUE(waitFor([&] { return device_->arrived(); }));
  settle();
  EXPECT_NEAR(steps_.force().norm(), press, 0.1 * press) << "the same cloth, solved better";
}

TEST_F(LiveTest, TheMeshFollowsOtherThresholds) {
  const double before = diagnostics_.number("solver", "active particles");
  accept({{"adapt/refine_above", 0.02},
          {"adapt/coarsen_below", 0.005},
          {"adapt/refine_above_strain", 1e-5},
          {"adapt/coarsen_below_strain", 1e-6},
          {"adapt/interval", 1}});
  ASSERT_TRUE(becomes("solver", "active particles", [&](double n) { return n > 1.2 * before; }));
  double fine = 0.0;
  ASSERT_TRUE(waitFor([&] {  // all cells that may split have split
    const double last = std::exchange(fine, diagnostics_.number("solver", "active particles"));
    ros::WallDuration(2.0).sleep();  // two messages
    return fine == last;
  }));
  accept({{"adapt/refine_above", 3.0},
          {"adapt/coarsen_below", 2.0},
          {"adapt/refine_above_strain", 0.5},
          {"adapt/coarsen_below_strain", 0.4},
          {"adapt/minimum_age", 0}});
  EXPECT_TRUE(becomes("solver", "active particles", [&](double n) { return n < 0.9 * fine; }));
}

TEST_F(LiveTest, TheHapticThreadTicksAtAnotherRate) {
  const double press = steps_.force().norm();
  steps_.expectRate(200.0);
  accept({{"haptics/rate", 200.0}});
  EXPECT_TRUE(
      becomes("haptic thread", "rate [Hz]", [](double rate) { return rate > 100.0 && rate < 220.0; }));
  settle();
  EXPECT_NEAR(steps_.force().norm(), press, 0.05 * press);
  accept({{"haptics/rate", 1000.0}});
  EXPECT_TRUE(becomes("haptic thread", "rate [Hz]", [](double rate) { return rate > 500.0; }));
}

TEST_F(LiveTest, DisplayRatesAndColoursChange) {
  std::atomic<long> states{0}, markers{0};
  std::atomic<float> green{0.0F};
  ros::Subscriber state =
      node_.subscribe<ClothState>("cloth/state", 100, [&](const ClothState::ConstPtr&) { ++states; });
  ros::Subscriber marker = node_.subscribe<visualization_msgs::MarkerArray>(
      "cloth/markers", 100, [&](const visualization_msgs::MarkerArray::ConstPtr& array) {
        // Lines of the first ten cells, because the list is longer than the visible part.
        const auto& colors = array->markers.at(1).colors;
        float least = 1.0F;
        for (std::size_t k = 0; k < 40; ++k) least = std::min(least, colors.at(k).g);
        green = least;
        ++markers;
      });
  ASSERT_TRUE(waitFor([&] { return states > 0 && markers > 0; }));
  // Both rates are measured by the same clock: the number of states per twenty markers.
  const auto statesPerMarker = [&] {
    const long first_state = states, first_marker = markers;
    EXPECT_TRUE(waitFor([&] { return markers >= first_marker + 20; }));
    return static_cast<double>(states - first_state) / static_cast<double>(markers - first_marker);
  };
  accept({{"state/rate", 5.0}, {"markers/rate", 20.0}});
  statesPerMarker();  // wait until the change has taken effect
  EXPECT_NEAR(statesPerMarker(), 0.25, 0.15);
  accept({{"state/rate", 40.0}, {"markers/rate", 20.0}});
  statesPerMarker();
  EXPECT_NEAR(statesPerMarker(), 2.0, 0.7);

  accept({{"markers/colouring", std::string("tension")}, {"markers/full_tension", 1e6}});
  EXPECT_TRUE(waitFor([&] { return std::abs(green - 0.95F) < 0.01F; })) << "no load worth a colour: white";
  accept({{"markers/full_tension", 1e-6}});
  EXPECT_TRUE(waitFor([&] { return green < 0.5F; })) << "every load is full: red";
  accept({{"markers/colouring", std::string("bending")}, {"markers/full_bending", 1e6}});
  EXPECT_TRUE(waitFor([&] { return std::abs(green - 0.95F) < 0.01F; }));
}

TEST_F(LiveTest, PosesAreJudgedByTheNewAge) {
  accept({{"max_pose_age", 1e-9}});
  EXPECT_TRUE(waitFor([&] { return steps_.force().isZero(0.0); })) << "all poses come too late now";
  accept({{"max_pose_age", 0.2}, {"velocity_time_constant", 0.01}, {"haptics/pose_timeout", 0.9}});
  EXPECT_TRUE(waitFor([&] { return steps_.force().z() > 0.1; }));
}

TEST_F(LiveTest, AnImpossibleValueIsRefusedAndTheOldOneStays) {
  const double press = steps_.force().norm();
  const auto refuse = [&](const LiveValues& values, const std::string& message) {
    SCOPED_TRACE(message);
    EXPECT_EQ(set(values), start_) << "the answer has what is in force";
    EXPECT_TRUE(waitFor([&] { return diagnostics_.value("options", "last refusal") == message; }))
        << diagnostics_.value("options", "last refusal");
  };
  refuse({{"probe/coupling_stiffness", -1.0}},
         "/haptic_cloth (live): probe.coupling_stiffness = -1: must be > 0");
  refuse({{"haptics/max_force", 1.0}, {"adapt/coarsen_below", 0.9}},
         "/haptic_cloth (live): adapt.coarsen_below = 0.9: must be below adapt.refine_above = 0.7");
  refuse({{"haptics/rate", 0.0}}, "/haptic_cloth (live): haptics/rate = 0: must be in 1 to 10000");
  refuse({{"adapt/levels", 0}}, "/haptic_cloth (live): adapt/levels = 0: cannot change while the node runs");
  EXPECT_EQ(node_.param("/haptic_cloth/haptics/max_force", 3.3), 3.3) << "1 N never was in force";
  settle();
  EXPECT_NEAR(steps_.force().norm(), press, 0.05 * press);
}

TEST_F(LiveTest, WhatIsInForceStandsAmongTheParameters) {
  accept({{"probe/coupling_damping", 2.0}, {"solver/max_iterations", 150}});
  double damping = 0.0;
  int iterations = 0;
  EXPECT_TRUE(node_.getParam("/haptic_cloth/probe/coupling_damping", damping));
  EXPECT_TRUE(node_.getParam("/haptic_cloth/solver/max_iterations", iterations));
  EXPECT_EQ(damping, 2.0);
  EXPECT_EQ(iterations, 150);
  // Tools that subscribe later receive the update too.
  const auto update = ros::topic::waitForMessage<dynamic_reconfigure::Config>(
      "/haptic_cloth/parameter_updates", node_, ros::Duration(kPatience));
  ASSERT_TRUE(update);
  EXPECT_EQ(toValues(*update).at("probe/coupling_damping"), LiveValue(2.0));
  const auto description = ros::topic::waitForMessage<dynamic_reconfigure::ConfigDescription>(
      "/haptic_cloth/parameter_descriptions", node_, ros::Duration(kPatience));
  ASSERT_TRUE(description);
  EXPECT_EQ(toValues(description->min).size(), toValues(*update).size());
}

}  // namespace
}  // namespace haptic_cloth::live_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_live_test");
  return RUN_ALL_TESTS();
}
