/// Work that services pass on: to the solver thread, and to threads that wait for files. Criteria:
/// every caller gets its own answer; waiting can be cancelled; a state has the requested options.
#include "ros/node/solver_tasks.h"

#include <gtest/gtest.h>
#include <ros/time.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "haptic_cloth/error.h"
#include "ros/node/file_work.h"
#include "ros/node/solver_loop.h"
#include "ros/node/steady_clock.h"
#include "ros/support/yaml_parameters.h"

namespace haptic_cloth::solver_tasks_test {
namespace {

constexpr double kPatience = 60.0;  ///< never reached [s]

bool never() { return false; }

TEST(FileWork, IsWaitedFor) {
  std::string text;
  EXPECT_TRUE(runFileWork([&] { text = "read"; }, never));
  EXPECT_EQ(text, "read");
  EXPECT_THROW(runFileWork([] { throw InputError("file", "", "", "bad"); }, never), InputError);
}

TEST(FileWork, IsLeftBehindWhereItIsCalledOff) {
  // The work waits for this promise as it would for a file system that does not answer.
  const auto answer = std::make_shared<std::promise<void>>();
  std::atomic<bool> begun{false};
  std::promise<void> ended;
  const auto work = [answer, &begun, &ended] {
    begun = true;
    answer->get_future().wait();
    ended.set_value_at_thread_exit();
  };
  EXPECT_FALSE(runFileWork(work, [&] { return begun.load(); }));
  answer->set_value();
  ended.get_future().wait();
}

class SolverTasksTest : public testing::Test {
 protected:
  SolverTasksTest()
      : options_(parseNodeOptions(sceneParameters(), "test")), shared_(options_), loop_(options_, shared_) {
    ros::Time::init();  // copies for the display have a stamp
  }

  /// Requests a change as a service does.
  void ask(const LiveValues& values) {
    const NodeOptions next = changed(*live_.options, values, "test");
    live_ = nextOptions(live_, next, steadyNow());
    shared_.live_for_solver.write(live_);
  }

  NodeOptions options_;
  SharedState shared_;
  SolverLoop loop_;
  LiveOptions live_ = firstOptions(options_);
};

TEST_F(SolverTasksTest, EveryCallerIsAnswered) {
  std::thread solver([this] { loop_.run(); });
  std::vector<std::future<int>> answers;
  for (int k = 0; k < 20; ++k) {
    answers.push_back(std::async(std::launch::async, [this, k] {
      int answer = -1;
      const auto work = [&](SolverLoop&) {
        answer = k;
        if (k == 7) throw InputError("seven", "", "", "is refused");
      };
      try {
        return shared_.tasks.run(work, shared_.stop, kPatience) ? answer : -2;
      } catch (const InputError&) {
        return -7;
      }
    }));
  }
  for (int k = 0; k < 20; ++k) EXPECT_EQ(answers[static_cast<std::size_t>(k)].get(), k == 7 ? -7 : k);
  shared_.stop = true;
  solver.join();
  EXPECT_FALSE(shared_.tasks.run([](SolverLoop&) {}, shared_.stop, kPatience)) << "nobody is there";
}

TEST_F(SolverTasksTest, AStateHasTheGainsThatWereAskedForAndSoHasLoadingIt) {
  ask({{"gain_ramp", 1000.0}, {"probe/coupling_stiffness", 900.0}});
  const std::string saved = loop_.saveState();
  Scene asked = options_.scene;
  asked.probes[0].coupling_stiffness = 900.0;
  EXPECT_NO_THROW(Simulation(asked).loadState(saved, "saved")) << "as a node that starts with them";
  EXPECT_NO_THROW(loop_.loadState(saved, "saved")) << "while they are still on their way";
  ask({{"probe/coupling_stiffness", 901.0}});
  EXPECT_THROW(loop_.loadState(saved, "saved"), InputError);
}

TEST_F(SolverTasksTest, AStateSavedInAPauseHasTheOptionsOfThePause) {
  // No step has applied them yet.
  ask({{"solver/tolerance", 0.2}});
  Scene asked = options_.scene;
  asked.solver.minimizer.tolerance = 0.2;
  EXPECT_NO_THROW(Simulation(asked).loadState(loop_.saveState(), "saved"));
}

/// Diagnostics in a pause show the cloth that is there: where it stopped, after a reset, after a load.
TEST_F(SolverTasksTest, StatisticsInAPauseAreThoseOfTheCloth) {
  std::thread solver([this] { loop_.run(); });
  double time = 0.0;
  std::string saved;
  const auto look = [&](SolverLoop& loop) { time = loop.simulation().time(); };
  const auto task = [&](const SolverTasks::Work& work) {
    ASSERT_TRUE(shared_.tasks.run(work, shared_.stop, kPatience));
  };
  const auto shows = [&](double expected) {
    for (int k = 0; k < 1000 && shared_.solver_stats.read().time != expected; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return shared_.solver_stats.read();
  };
  while (time < 0.05) task(look);
  shared_.paused = true;
  task(look);  // no step follows
  EXPECT_GT(time, 0.0);
  EXPECT_EQ(shows(time).time, time);
  task([&](SolverLoop& loop) { saved = loop.saveState(); });
  task([](SolverLoop& loop) { loop.reset(); });
  const SolverStats after_reset = shows(0.0);
  EXPECT_EQ(after_reset.time, 0.0);
  EXPECT_EQ(after_reset.kinetic, 0.0);
  EXPECT_GT(after_reset.last.active_particles, 0);
  EXPECT_EQ(after_reset.wall, 0.0) << "rates are those of the other cloth";
  task([&](SolverLoop& loop) { loop.loadState(saved, "saved"); });
  EXPECT_EQ(shows(time).time, time);
  EXPECT_EQ(shared_.solver_stats.read().force_errors.size(), 1u);
  shared_.stop = true;
  solver.join();
}

/// The first window of the statistics lasts a second. Criterion: kHanging of diagnostics.cpp, after which
/// steps count as missing.
TEST_F(SolverTasksTest, StatisticsKnowTheFirstStepAfterAPause) {
  constexpr double kPaused = 2.5;  // [s]
  std::thread solver([this] { loop_.run(); });
  const auto taken = [this](double after) {
    for (int k = 0; k < 10000 && !(shared_.solver_stats.read().taken > after); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return shared_.solver_stats.read().taken;
  };
  const double begun = taken(0.0);
  EXPECT_GT(begun, 0.0);
  shared_.paused = true;
  sleepUntil(steadyNow() + kPaused);
  const double resumed = steadyNow();
  shared_.paused = false;
  EXPECT_GT(taken(resumed), resumed);
  EXPECT_EQ(shared_.solver_stats.read().wall, 0.0) << "before the window ends";
  shared_.stop = true;
  solver.join();
}

TEST_F(SolverTasksTest, ARampGoesOnAfterAStateWasSaved) {
  // Where the ramp stands, the haptic thread says.
  HapticSession& session = *shared_.probes[0].impedance;
  HapticOptions reached = session.options();
  reached.coupling_stiffness = 500.0;
  session.setOptions(reached);
  std::thread solver([this] { loop_.run(); });
  ask({{"gain_ramp", 1000.0}, {"probe/coupling_stiffness", 900.0}});
  double saved_at = 0.0, time = 0.0, stiffness = 0.0;
  const auto look = [&](SolverLoop& loop) {
    time = loop.simulation().time();
    stiffness = loop.simulation().scene().probes[0].coupling_stiffness;
  };
  ASSERT_TRUE(shared_.tasks.run(
      [&](SolverLoop& loop) {
        loop.saveState();
        saved_at = loop.simulation().time();
      },
      shared_.stop, kPatience));
  while (time <= saved_at) {
    ASSERT_TRUE(shared_.tasks.run(look, shared_.stop, kPatience));
  }
  EXPECT_EQ(stiffness, 500.0);
  shared_.stop = true;
  solver.join();
}

}  // namespace
}  // namespace haptic_cloth::solver_tasks_test
