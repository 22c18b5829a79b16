/// Clock and quality ladder with a simulated solver, whose steps take a time that is a function of length
/// and rung.
/// Criteria: those of clock_keeper.h; simulated over wall time is at least 0.95 where some rung is fast
/// enough.
#include "haptics/clock_keeper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/step_pacer.h"
#include "haptics/quality_ladder.h"
#include "support/scenes.h"

namespace haptic_cloth::clock_keeper_test {
namespace {

constexpr double kStep = 1e-3;  // [s]

/// Wall time of a step [s]. @param length in time steps  @param now at its start [s]
using Cost = std::function<double(int length, int rung, double now)>;

/// Whether a step used up its iterations. @param now at its end [s]
using Cut = std::function<bool(int rung, double now)>;
bool nothingIsCut(int, double) { return false; }

/// A solver that keeps the clock.
class Loop {
 public:
  Loop(std::vector<int> longest, Cost cost, int gentle = 9, Cut cut = nothingIsCut)
      : longest_(std::move(longest)), cost_(std::move(cost)), cut_(std::move(cut)) {
    keeper_.setRungs(longest_, gentle);
  }

  void run(double seconds) {
    for (const double end = now_ + seconds; now_ < end;) step();
  }

  void step() {
    now_ = std::max(now_, keeper_.due(now_));
    const int length = last_.length, rung = last_.rung;
    last_ = keeper_.begin(now_);
    const double simulated = ticks_ * kStep + paused_;
    EXPECT_GE(now_, simulated - 1e-9) << "ahead of the clock";
    EXPECT_LE(last_.length, 2 * length);
    EXPECT_GE(2 * last_.length, length);
    EXPECT_LE(last_.length, std::max(longest_[last_.rung], (length + 1) / 2));
    EXPECT_LE(last_.rung, rung + 2);
    EXPECT_GE(last_.rung, rung - 1);
    if (last_.rung != rung) ++changes_;
    ticks_ += last_.length;
    now_ += cost_(last_.length, last_.rung, now_);
    keeper_.end(now_, cut_(last_.rung, now_));
  }

  void pause(double seconds) {
    keeper_.restart();
    now_ += seconds;
    paused_ = now_ - ticks_ * kStep;
  }

  double now() const { return now_; }
  double simulated() const { return ticks_ * kStep; }
  int rung() const { return last_.rung; }
  int length() const { return last_.length; }
  int changes() const { return changes_; }  ///< of the rung, so far
  const ClockKeeper& keeper() const { return keeper_; }

 private:
  std::vector<int> longest_;
  Cost cost_;
  Cut cut_;
  ClockKeeper keeper_{kStep};
  ClockKeeper::Step last_{1, 0};
  double now_ = 0.0, paused_ = 0.0;
  long ticks_ = 0;
  int changes_ = 0;
};

const std::vector<int> kLongest{1, 2, 4, 4, 4, 4, 4, 4, 4};

/// A solver whose rungs cost less and less: load at steps of 1 ms on the best rung, and on each other one.
/// A step four times as long costs 2.6 times as much, as haptic_slide does.
Cost solver(double load, double cheaper) {
  return [=](int length, int rung, double) {
    return kStep * load * std::pow(cheaper, rung) * std::pow(length, 0.7);
  };
}

TEST(ClockKeeper, AFastSolverKeepsTheQualityOfTheScene) {
  Loop loop(kLongest, solver(0.8, 0.7));
  loop.run(10.0);
  EXPECT_EQ(loop.changes(), 0);
  EXPECT_EQ(loop.length(), 1);
  EXPECT_EQ(loop.keeper().slipped(), 0.0);
  EXPECT_NEAR(loop.simulated(), loop.now(), 2.0 * kStep);
}

TEST(ClockKeeper, ASlowSolverGivesUpQualityAndKeepsTheClock) {
  for (const double load : {1.2, 2.0, 4.0, 8.0}) {
    Loop loop(kLongest, solver(load, 0.7));
    loop.run(10.0);
    EXPECT_GT(loop.rung(), 0) << load;
    EXPECT_GE(loop.simulated() / loop.now(), 0.95) << load;
    // All that is missing is known: what has slipped, and the lag that may be left.
    EXPECT_NEAR(loop.simulated() + loop.keeper().slipped(), loop.now(), 0.11) << load;
  }
}

/// At load 8, steps of 4 ms take 2.6 times their length at rung 2, 1.3 times at rung 4 and 0.89 times at rung
/// 5. Two falls by two and one by one, each within 30 ms and a step, lose less than 0.1 s. Five falls by one
/// would lose more.
TEST(ClockKeeper, FallsFasterIfFarTooSlow) {
  Loop loop(kLongest, solver(8.0, 0.7));
  loop.run(5.0);
  EXPECT_EQ(loop.rung(), 5);
  EXPECT_EQ(loop.changes(), 3);
  EXPECT_EQ(loop.keeper().slipped(), 0.0);
  Loop careful(kLongest, solver(8.0, 0.7), 4,
               [](int, double) { return true; });  // 4 and on cost the force much
  careful.run(5.0);
  EXPECT_EQ(careful.rung(), 5);
  EXPECT_EQ(careful.changes(), 4);
}

TEST(ClockKeeper, OneLongStepCostsNoMoreThanOneRung) {
  // A little behind already, as the first step of 1 ms takes 6 ms; the next takes 60 ms.
  Loop loop(kLongest, [](int length, int, double now) {
    return now < 1e-3 ? 6e-3 : now < 0.02 ? 0.06 : 0.5 * kStep * length;
  });
  loop.run(0.4);
  EXPECT_LE(loop.changes(), 1);
  EXPECT_LE(loop.rung(), 1);
}

TEST(ClockKeeper, QualityComesBackWhenALoadEnds) {
  const auto factor = [](double now) { return now > 5.0 && now < 15.0 ? 6.0 : 1.0; };
  const Cost quiet = solver(0.4, 0.7);
  Loop loop(kLongest,
            [=](int length, int rung, double now) { return factor(now) * quiet(length, rung, now); });
  loop.run(5.0);
  EXPECT_EQ(loop.rung(), 0);
  loop.run(10.0);
  EXPECT_GE(loop.rung(), 2);
  loop.run(15.0);
  EXPECT_EQ(loop.rung(), 0);
  EXPECT_GE(loop.simulated() / loop.now(), 0.95);
}

TEST(ClockKeeper, ARungIsJudgedByItsLongestSteps) {
  // Each rung takes 0.7 of the time of the one before. Rung 6 takes 0.59 of the time in steps of 1 ms, which
  // it uses if there is no lag; that leaves too little for rung 5. Steps of 4 ms take 0.39: rung 5 is tried.
  double factor = 4.0;
  const Cost cost = solver(5.0, 0.7);
  Loop loop(kLongest, [&](int length, int rung, double now) { return factor * cost(length, rung, now); });
  loop.run(5.0);
  EXPECT_EQ(loop.rung(), 8);
  factor = 1.0;
  loop.run(30.0);
  EXPECT_LE(loop.rung(), 5);
  const double slipped = loop.keeper().slipped();
  loop.run(30.0);
  EXPECT_LE(loop.rung(), 5);
  EXPECT_EQ(loop.keeper().slipped(), slipped);
}

/// Rungs 3 and 4 limit the iterations. A hard blow, in which they are used up, leads to rung 4. After it each
/// of these rungs takes 0.9 of the time, which leaves no room by the load; but nothing is cut, so that the
/// better rung costs the same. Two rises with waits of 0.5 s lead to rung 2, which leaves no room.
TEST(ClockKeeper, ALimitOfIterationsThatIsNotUsedUpIsLifted) {
  const auto blow = [](double now) { return now < 1.0; };
  const Cost cost = [&](int length, int rung, double now) {
    return kStep * length * (blow(now) ? 4.0 - 0.8 * rung : 0.9);
  };
  Loop loop({1, 2, 4, 4, 4}, cost, 3, [&](int, double now) { return blow(now); });
  loop.run(1.0);
  EXPECT_EQ(loop.rung(), 4);
  loop.run(2.0);
  EXPECT_EQ(loop.rung(), 2);
  // So is one in shorter steps: the better rung need not use its longer ones.
  Loop shorter({1, 2, 4, 2, 2}, cost, 3, [&](int, double now) { return blow(now); });
  shorter.run(1.0);
  EXPECT_EQ(shorter.rung(), 4);
  shorter.run(2.0);
  EXPECT_EQ(shorter.rung(), 2);
  // A rung with longer steps costs less, whatever the iterations: two of half the length would take longer.
  Loop longer({1, 2, 2, 2, 4}, cost, 3, [&](int, double now) { return blow(now); });
  longer.run(3.0);
  EXPECT_EQ(longer.rung(), 4);
  // A rung whose steps are cut stays.
  Loop busy({1, 2, 4, 4, 4}, cost, 3, [](int, double) { return true; });
  busy.run(3.0);
  EXPECT_EQ(busy.rung(), 4);
}

TEST(ClockKeeper, AClockThatIsSetBackOrIsNoNumberStopsNothing) {
  ClockKeeper keeper(kStep);
  keeper.begin(3600.0);
  keeper.end(3600.0005, false);
  EXPECT_EQ(keeper.due(5.0), 5.0) << "an hour back";
  keeper.begin(5.0);
  keeper.end(5.0005, false);
  EXPECT_NEAR(keeper.due(5.0005), 5.0 + kStep, 1e-9);
  for (const double odd : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    keeper.begin(odd);
    keeper.end(odd, false);
  }
  EXPECT_LE(keeper.due(5.002), 5.0 + 4.0 * kStep);
  EXPECT_LT(keeper.slipped(), 1e-9);
}

TEST(ClockKeeper, DoesNotChatter) {
  // Rung 1 looks as if it left room, but rung 0 is too slow. Waits of 0.5, 1, 2 ... 30 s make at most 6 + 10
  // attempts in five minutes, and each is a rise and a fall.
  Loop loop({1, 2}, [](int length, int rung, double) { return kStep * length * (rung == 0 ? 1.5 : 0.3); });
  loop.run(300.0);
  EXPECT_LE(loop.changes(), 2 * 16 + 1);
  EXPECT_GE(loop.changes(), 3) << "it never tried";
  EXPECT_GE(loop.simulated() / loop.now(), 0.95);
}

TEST(ClockKeeper, ComesBackSoonAfterManyFailedAttempts) {
  // Under load rung 3 seems to leave room, but rung 2 is too slow: the wait for rung 2 grows to 30 s. It must
  // not hold up the rungs beyond.
  const auto loaded = [](double now) { return now < 120.0; };
  Loop loop({1, 2, 4, 4}, [&](int length, int rung, double now) {
    return kStep * length * (loaded(now) ? (rung < 3 ? 1.5 : 0.3) : 0.2);
  });
  loop.run(120.0);
  EXPECT_GE(loop.rung(), 2);
  loop.run(33.0);
  EXPECT_EQ(loop.rung(), 0);
}

TEST(ClockKeeper, StepsLongerThanTheLongestLagStillLoseQuality) {
  // A rung that needs 1.5 times the time is left although its steps may be longer than the lag that is kept.
  Loop loop({101, 101},
            [](int length, int rung, double) { return kStep * length * (rung == 0 ? 1.5 : 0.7); });
  loop.run(2.0);
  EXPECT_EQ(loop.rung(), 1);
}

TEST(ClockKeeper, AStallIsCaughtUpWithoutLossOfQuality) {
  bool stalled = false;
  Loop loop(kLongest, [&](int, int, double now) {
    const bool stall = !stalled && now > 1.0;
    stalled = stalled || stall;
    return stall ? 0.05 : 0.4 * kStep;
  });
  loop.run(2.0);
  EXPECT_EQ(loop.changes(), 0);
  EXPECT_EQ(loop.keeper().slipped(), 0.0);
  EXPECT_NEAR(loop.simulated(), loop.now(), 2.0 * kStep);
}

TEST(ClockKeeper, WhatNoRungCanHoldSlips) {
  Loop loop(kLongest, [](int length, int, double) { return 2.0 * kStep * length; });
  loop.run(10.0);
  EXPECT_EQ(loop.rung(), 8);
  EXPECT_EQ(loop.length(), 4);
  EXPECT_NEAR(loop.keeper().slipped(), 5.0, 0.2);
}

TEST(ClockKeeper, APauseIsNoLag) {
  Loop loop(kLongest, solver(0.5, 0.7));
  loop.run(1.0);
  loop.pause(10.0);
  loop.run(1.0);
  EXPECT_EQ(loop.changes(), 0);
  EXPECT_EQ(loop.keeper().slipped(), 0.0);
}

TEST(ClockKeeper, OneRungOfOneStepIsAFixedStep) {
  Loop loop({1}, [](int, int, double) { return 3.0 * kStep; });
  loop.run(3.0);
  EXPECT_EQ(loop.length(), 1);
  EXPECT_NEAR(loop.simulated() + loop.keeper().slipped(), loop.now(), 0.11);
}

TEST(QualityLadder, BeginsWithTheSceneAndGetsCoarser) {
  const SolverOptions solver;
  const AdaptOptions adapt;
  const std::vector<Quality> ladder = qualityLadder(solver, adapt, 4);
  ASSERT_EQ(ladder.size(), 10u);
  EXPECT_EQ(ladder[0].longest_step, 1);
  EXPECT_EQ(ladder[0].given_up, "");
  EXPECT_EQ(ladder[0].solver.minimizer.tolerance, solver.minimizer.tolerance);
  EXPECT_EQ(ladder[0].adapt.refine_above, adapt.refine_above);
  for (std::size_t k = 1; k < ladder.size(); ++k) {
    const Quality &fine = ladder[k - 1], &coarse = ladder[k];
    EXPECT_TRUE(coarse.longest_step >= fine.longest_step ||
                coarse.solver.minimizer.max_iterations < fine.solver.minimizer.max_iterations);
    EXPECT_GE(coarse.solver.minimizer.tolerance, fine.solver.minimizer.tolerance);
    EXPECT_LE(coarse.solver.minimizer.max_iterations, fine.solver.minimizer.max_iterations);
    EXPECT_GE(coarse.adapt.far_angle_factor, fine.adapt.far_angle_factor);
    EXPECT_GE(coarse.adapt.far_strain_factor, fine.adapt.far_strain_factor);
    EXPECT_LE(coarse.adapt.near_reach, fine.adapt.near_reach);
    EXPECT_GE(coarse.adapt.near_load, fine.adapt.near_load);
    EXPECT_NE(coarse.given_up, fine.given_up);
  }
  EXPECT_EQ(ladder[1].given_up, "tolerance 1, steps to 2 ms, 200 iterations");
  EXPECT_EQ(ladder[6].longest_step, 4);
  EXPECT_EQ(ladder[8].given_up,
            "tolerance 1, steps to 2 ms, mesh thresholds x 5 beyond 2 cells of probes, 10 iterations");
  EXPECT_EQ(ladder[9].given_up,
            "tolerance 1, steps to 4 ms, mesh thresholds x 5 beyond 2 cells of probes, 10 iterations");
}

TEST(QualityLadder, ShowsStrainsOfAMeshThatGoesByStrainAlone) {
  AdaptOptions adapt;
  adapt.refine_above = 5.0;  // beyond any turning angle
  const std::vector<Quality> ladder = qualityLadder(SolverOptions(), adapt, 4);
  EXPECT_EQ(
      ladder[2].given_up,
      "tolerance 1, steps to 2 ms, mesh thresholds x 2 beyond 8 cells of probes and below 3 % of their load, "
      "200 iterations");
  EXPECT_EQ(
      ladder[3].given_up,
      "tolerance 1, steps to 2 ms, mesh thresholds x 8 beyond 8 cells of probes and below 3 % of their load, "
      "200 iterations");
  EXPECT_EQ(ladder[4].given_up,
            "tolerance 1, steps to 2 ms, mesh thresholds x 32 beyond 8 cells of probes and below 3 % of "
            "their load, 200 iterations");
}

TEST(StepPacer, RefusesStepsOfNoLength) {
  const Simulation simulation(sheetScene(makeFabric({}), 5, 5, 0.1, 0.1));
  PaceOptions pace;
  StepPacer pacer(simulation, pace);
  const Scene& scene = simulation.scene();
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    pace.max_time_step = bad;
    EXPECT_THROW(StepPacer(simulation, pace), InputError) << bad;
    EXPECT_THROW(pacer.setOptions(scene.solver, scene.adapt, scene.air_damping, pace), InputError) << bad;
  }
}

TEST(QualityLadder, StaysWithinTheRangeOfTheFarFactors) {
  Scene scene = sheetScene(makeFabric({}), 5, 5, 0.1, 0.1);
  scene.adapt.far_angle_factor = scene.adapt.far_strain_factor = 300.0;
  for (const Quality& rung : qualityLadder(scene.solver, scene.adapt, 4)) {
    scene.adapt = rung.adapt;
    EXPECT_NO_THROW(validateScene(scene, rung.given_up));
  }
}

TEST(QualityLadder, IsNeverFinerThanTheScene) {
  SolverOptions solver;
  solver.minimizer.tolerance = 3.0;
  solver.minimizer.max_iterations = 15;
  AdaptOptions adapt;
  adapt.interval = 9;
  for (const Quality& rung : qualityLadder(solver, adapt, 4)) {
    EXPECT_EQ(rung.solver.minimizer.tolerance, 3.0);
    EXPECT_LE(rung.solver.minimizer.max_iterations, 15);
    EXPECT_EQ(rung.adapt.interval, 9);
  }
}

TEST(QualityLadder, LeavesOutRungsThatChangeNothing) {
  SolverOptions solver;
  solver.minimizer.tolerance = 1.0;
  solver.minimizer.max_iterations = 10;
  AdaptOptions adapt;
  adapt.strategy = Strategy::Finest;
  EXPECT_EQ(qualityLadder(solver, adapt, 1).size(), 1u);
  EXPECT_EQ(qualityLadder(solver, adapt, 2).size(), 2u);
  EXPECT_EQ(qualityLadder(solver, adapt, 8).size(), 3u);
}

}  // namespace
}  // namespace haptic_cloth::clock_keeper_test
