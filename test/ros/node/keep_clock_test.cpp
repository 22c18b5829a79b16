/// A node that keeps the clock while programs take all cores and its scene asks for more than any machine can
/// do. Criteria: quality goes down, and comes back when there is time; time slips between few messages only,
/// unless the last rung is in use, which is all that the node can do on a machine that is too busy (what
/// share of time slips: bench/realtime); simulated and slipped time make up wall time; a recording replays to
/// the same state.
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/ros.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <filesystem>
#include <mutex>
#include <thread>

#include "haptic_cloth/simulation.h"
#include "haptic_cloth/state_file.h"
#include "haptics/quality_ladder.h"
#include "ros/node/steady_clock.h"
#include "ros/options/reconfigure_messages.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::keep_clock_test {
namespace {

const Vec3 kAbove(0.0, 0.0, 0.125), kPressed(0.0, 0.0, 0.100);
constexpr int kEnough = 40;  // prompt messages, of which a quarter tells more than chance
constexpr double kTimeStep = 5e-4, kLongest = 4e-3;  // of the scene and of the node [s]
const int kLastRung = static_cast<int>(qualityLadder(SolverOptions(), AdaptOptions(), 8).size()) - 1;

/// Newest state of the cloth, and what was the worst of several.
class StateListener {
 public:
  explicit StateListener(ros::NodeHandle& node) {
    subscriber_ = node.subscribe<ClothState>("cloth/state", 1, [this](const ClothState::ConstPtr& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      const double now = steadyNow();
      const bool prompt = now - received_ <= kLag;
      if (prompt) ++messages_;
      if (prompt && message->slipped > state_.slipped) ++slips_;
      received_ = now;
      if (message->rung > state_.rung) fallen_ = now;
      state_ = *message;
      heard_ = true;
      worst_rung_ = std::max<int>(worst_rung_, message->rung);
      behind_ = std::min(behind_, now - message->time - message->slipped);
    });
  }
  struct Reading {
    ClothState state;
    int worst_rung;  ///< since the last reading
    /// Messages since the last reading that came soon enough after the one before: where they take longer
    /// the machine did not run the node, which then may let time slip.
    int messages;
    int slips;  ///< of these, how many found that time had slipped
    /// Wall time minus simulated and slipped time [s]: a constant, plus the lag and the delay of the message.
    /// This is the least since the last reading.
    double behind;
  };
  Reading read() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Reading reading{state_, worst_rung_, messages_, slips_, behind_};
    worst_rung_ = state_.rung;
    messages_ = slips_ = 0;
    behind_ = kNever;
    return reading;
  }
  int rung() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.rung;
  }
  double fallen() const {  ///< when quality last went down [s]
    const std::lock_guard<std::mutex> lock(mutex_);
    return fallen_;
  }
  bool heard() const { return heard_; }

 private:
  static constexpr double kNever = 1e300;
  static constexpr double kLag = 0.1;  ///< that a node makes up for without a slip [s]
  mutable std::mutex mutex_;
  ClothState state_;
  std::atomic<bool> heard_{false};
  int worst_rung_ = 0, messages_ = 0, slips_ = 0;
  double behind_ = kNever, received_ = -kNever, fallen_ = -kNever;
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

class KeepClock : public testing::Test {
 protected:
  KeepClock() : spinner_(2), reaction_(node_, "probe/reaction"), state_(node_), diagnostics_(node_) {
    spinner_.start();
  }

  void SetUp() override {
    ASSERT_TRUE(waitFor([this] { return reaction_.count() > 0 && state_.heard(); }))
        << "the node does not run";
    device_ = std::make_unique<TestDevice>(node_, kAbove);
    ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  }

  void TearDown() override {
    ask(0.1, 200, true);
    EXPECT_TRUE(reaction_.finite());
  }

  void ask(double tolerance, int max_iterations, bool keep_clock) {
    dynamic_reconfigure::Reconfigure call;
    auto& config = call.request.config;
    config.doubles.resize(1);
    config.doubles[0].name = "solver/tolerance";
    config.doubles[0].value = tolerance;
    config.ints.resize(1);
    config.ints[0].name = "solver/max_iterations";
    config.ints[0].value = max_iterations;
    config.bools.resize(1);
    config.bools[0].name = "keep_clock";
    config.bools[0].value = keep_clock;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/set_parameters", call));
  }
  /// Asks for solutions to the last bit.
  void askForTooMuch(bool keep_clock) { ask(0.0, 2000, keep_clock); }

  /// Waits until quality is back while the cloth rests, which takes no time. If it still goes down, the
  /// machine has stopped the node, and patience starts again; the launch file limits the whole.
  bool qualityComesBack() {
    const double start = steadyNow();
    const auto patient = [&] { return steadyNow() < std::max(start, state_.fallen()) + 4 * kPatience; };
    waitFor([&] { return state_.rung() == 0 || !patient(); }, 20 * kPatience);
    return state_.rung() == 0;
  }

  /// Moves the hand up and down on the cloth. The probe keeps touching.
  void stir(double seconds) {
    for (const double end = steadyNow() + seconds; steadyNow() < end;) {
      for (const double z : {0.095, 0.100}) {
        device_->moveTo(Vec3(0.0, 0.0, z));
        waitFor([&] { return device_->arrived(); });
      }
    }
  }

  /// Stirs until there were enough prompt messages, if the machine is not too busy for that.
  StateListener::Reading stirForMessages() {
    constexpr int kMostRounds = 5;
    StateListener::Reading all{};
    for (int round = 0; round < kMostRounds && all.messages < kEnough; ++round) {
      stir(8.0);
      const StateListener::Reading more = state_.read();
      all = {more.state, std::max(all.worst_rung, more.worst_rung), all.messages + more.messages,
             all.slips + more.slips, more.behind};
    }
    return all;
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  ReactionListener reaction_;
  StateListener state_;
  DiagnosticsListener diagnostics_;
  std::unique_ptr<TestDevice> device_;
};

TEST_F(KeepClock, GivesUpQualityUnderLoadAndTakesItBack) {
  std::deque<Process> burners;
  for (unsigned k = 0; k < std::max(1U, std::thread::hardware_concurrency()); ++k) {
    burners.emplace_back(std::vector<std::string>{"sh", "-c", "while :; do :; done"});
  }
  askForTooMuch(true);
  stir(2.0);
  EXPECT_TRUE(waitFor([&] { return state_.rung() > 0; })) << "quality does not go down";
  const StateListener::Reading start = state_.read();
  const StateListener::Reading end = stirForMessages();
  // A solver that is too slow slips between any two messages. One that the system stops now and then, as a
  // full machine does, slips only then. Where it hardly runs at all, few messages are prompt, and tell
  // nothing.
  EXPECT_TRUE(4 * end.slips <= end.messages || end.worst_rung == kLastRung || end.messages < kEnough)
      << "slipped between " << end.slips << " of " << end.messages << " prompt messages, rung "
      << end.worst_rung;
  EXPECT_GT(end.worst_rung, 0);
  EXPECT_LE(end.state.step_length, 1.001 * kLongest);
  EXPECT_TRUE(waitFor([&] {
    return diagnostics_.number("solver", "quality rung") > 0.0 &&
           diagnostics_.value("solver", "given up") != "nothing";
  }));

  burners.clear();
  ask(0.1, 200, true);
  device_.reset();  // the cloth comes to rest
  EXPECT_TRUE(qualityComesBack());
  EXPECT_EQ(state_.read().state.given_up, "");
  // Before and after the load messages come soon. The lag of at most 0.1 s, and the least delay of 60
  // messages.
  ros::WallDuration(2.0).sleep();
  EXPECT_NEAR(start.behind, state_.read().behind, 0.5)
      << "simulated and slipped time do not make up wall time";
}

TEST_F(KeepClock, IsLeftAloneWhereSlowMotionIsAskedFor) {
  ASSERT_TRUE(qualityComesBack());
  askForTooMuch(false);
  device_->moveTo(kPressed);
  stir(2.0);
  const StateListener::Reading slow = state_.read();
  EXPECT_EQ(slow.state.rung, 0);
  EXPECT_DOUBLE_EQ(slow.state.step_length, kTimeStep);
  askForTooMuch(true);
  stir(1.0);
  EXPECT_TRUE(waitFor([&] { return state_.rung() > 0; })) << "keep_clock does not take effect";
}

TEST_F(KeepClock, AStateIsThatOfTheSceneWhateverItsQuality) {
  const std::string file = testing::TempDir() + "haptic_cloth_keep_clock_" + std::to_string(getpid());
  askForTooMuch(true);
  device_->moveTo(kPressed);
  stir(1.0);
  ASSERT_TRUE(waitFor([&] { return state_.rung() > 0; }));
  SaveState save;
  save.request.file = file;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/save_state", save));
  EXPECT_TRUE(save.response.success) << save.response.message;
  Scene scene = loadScene(HAPTIC_CLOTH_SOURCE_DIR "/test/ros/node/keep_clock.yaml");
  scene.solver.minimizer.tolerance = 0.0;
  scene.solver.minimizer.max_iterations = 2000;
  EXPECT_NO_THROW(Simulation(scene).loadState(readStateFile(file, largestState(scene)), file));
  LoadState load;
  load.request.file = file;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/load_state", load));
  EXPECT_TRUE(load.response.success) << load.response.message;
  std::filesystem::remove(file);
}

/// A second node, whose inputs are recorded while a hand presses.
TEST(Recording, ReplaysASessionToTheSameBits) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("haptic_cloth_recording_" + std::to_string(getpid()));
  const std::string scene = HAPTIC_CLOTH_SOURCE_DIR "/test/ros/node/keep_clock.yaml";
  ros::NodeHandle node("recorded");
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ReactionListener reaction(node, "probe/reaction");
  Process cloth({programDirectory() + "/haptic_cloth_node", "__ns:=recorded", "__name:=cloth",
                 "_scene_file:=" + scene, "_record:=" + file.string(), "_step_budget:=0.0",
                 "_solver/tolerance:=0.0001", "_haptics/pose_timeout:=1.0",
                 "_haptics/snapshot_timeout:=1.0"});
  ASSERT_TRUE(waitFor([&] { return reaction.count() > 0; })) << cloth.output();
  {
    TestDevice device(node, kAbove);
    const long seen = reaction.count();
    ASSERT_TRUE(waitFor([&] { return reaction.count() > seen + 1000; }));
    device.moveTo(kPressed);
    EXPECT_TRUE(waitFor([&] { return device.arrived() && reaction.force().z() > 0.05; })) << cloth.output();
  }
  cloth.signal(SIGINT);
  EXPECT_EQ(cloth.wait(), 0) << cloth.output();
  Process replay({programDirectory() + "/simulate", scene, "--set", "solver.tolerance=0.0001", "--replay",
                  file.string()});
  EXPECT_EQ(replay.wait(10 * kPatience), 0) << replay.output();
  EXPECT_NE(replay.output().find("replayed to the same state"), std::string::npos) << replay.output();
  std::filesystem::remove(file);
}

TEST(Recording, IsRefusedWhereAClockTakesPart) {
  Process cloth({programDirectory() + "/haptic_cloth_node", "__ns:=refused", "__name:=cloth",
                 "_scene_file:=" HAPTIC_CLOTH_SOURCE_DIR "/test/ros/node/keep_clock.yaml",
                 "_record:=/tmp/x"});
  EXPECT_NE(cloth.wait(), 0);
  EXPECT_NE(cloth.output().find("step_budget = 0.025: must be 0 with record = /tmp/x"), std::string::npos)
      << cloth.output();
}

}  // namespace
}  // namespace haptic_cloth::keep_clock_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "keep_clock_test");
  return RUN_ALL_TESTS();
}
