/// Sessions as their two threads drive them, on one thread and an artificial clock: a tick and a step
/// each millisecond. Criteria: the limits of HapticOptions, exact but for round-off; at rest the
/// force is the coupling's, k (proxy - device).
#include "haptic_cloth/haptic_session.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptic_cloth/error.h"
#include "haptics/step_interval.h"
#include "sim/turn_spring.h"
#include "support/scenes.h"

namespace haptic_cloth::haptic_session_test {
namespace {

constexpr double kRoundOff = 1e-9;

Scene pinnedSheet() {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 17, 17, 0.16, 0.16);
  scene.air_damping = 5.0;
  pinAllSides(scene);
  return scene;
}

class HapticSessionTest : public ::testing::Test {
 protected:
  static constexpr double kTick = 1e-3;  ///< [s]

  HapticSessionTest() : simulation_(pinnedSheet()), session_(simulation_.scene(), 0, options_) {}

  /// One tick without a step. Checks what holds for every tick.
  void tick(const Vec3& position, bool paused = false) {
    time_ += kTick;
    take(session_.tick({position, Quat::Identity()}, time_, paused));
  }

  void tickWithoutPose() {
    time_ += kTick;
    take(session_.tick(time_));
  }

  void step() {
    session_.beforeStep(simulation_, time_);
    simulation_.step();
    session_.afterStep(simulation_, time_);
  }

  /// Presses from above to 5 mm below the sheet's plane and stays there.
  void press(int ticks = 1000) {
    for (int k = 0; k < ticks; ++k) {
      tick(Vec3(0.0, 0.0, std::max(-0.005, 0.015 - 1e-4 * k)));
      step();
    }
  }

  double force() const { return force_.norm(); }  ///< of the last tick [N]
  ProbeReport probe() const { return simulation_.probe(); }

  HapticOptions options_;
  Simulation simulation_;
  HapticSession session_;
  double time_ = 10.0;  ///< [s]

 private:
  void take(const Wrench& wrench) {
    ASSERT_TRUE(wrench.force.allFinite() && wrench.torque.allFinite());
    EXPECT_LE(wrench.force.norm(), options_.max_force * (1.0 + kRoundOff));
    EXPECT_LE((wrench.force - force_).norm(), options_.max_force_rate * kTick * (1.0 + kRoundOff));
    force_ = wrench.force;
  }

  Vec3 force_ = Vec3::Zero();
};

TEST_F(HapticSessionTest, GivesTheForceOfTheCoupling) {
  press();
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
  const Vec3 stretch = probe().proxy - probe().device;
  const double expected = simulation_.scene().probes[0].coupling_stiffness * stretch.z();
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(force(), expected, 0.02 * expected);  // the sheet still swings a little
}

TEST_F(HapticSessionTest, GivesNothingWithoutContact) {
  for (int k = 0; k < 20; ++k) {
    tick(Vec3(0.0, 0.0, 0.05));
    step();
  }
  EXPECT_EQ(session_.status(), HapticStatus::Free);
  EXPECT_TRUE(probe().present);
  EXPECT_EQ(force(), 0.0);
}

TEST_F(HapticSessionTest, SaysThatAProbeAppearedInTheCloth) {
  const auto hold = [&](double z) {
    for (int k = 0; k < 20; ++k) {
      tick(Vec3(0.0, 0.0, z));
      step();
    }
  };
  hold(0.003);  // the sheet is 3 mm below the centre of a sphere of 8 mm
  EXPECT_EQ(session_.status(), HapticStatus::Inside);
  EXPECT_EQ(force(), 0.0);
  hold(0.03);
  EXPECT_EQ(session_.status(), HapticStatus::Free);
  hold(0.003);
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
}

TEST_F(HapticSessionTest, RampsToZeroWhilePaused) {
  press();
  for (int k = 0; k < 30; ++k) tick(Vec3(0.0, 0.0, -0.005), true);  // ramp_time: 20 ms
  EXPECT_EQ(session_.status(), HapticStatus::Paused);
  EXPECT_EQ(force(), 0.0);
}

TEST_F(HapticSessionTest, RampsToZeroWhenStepsStop) {
  press();
  for (int k = 0; k < 130; ++k) tick(Vec3(0.0, 0.0, -0.005));  // snapshot_timeout + ramp_time: 120 ms
  EXPECT_EQ(session_.status(), HapticStatus::SnapshotStale);
  EXPECT_EQ(force(), 0.0);
}

TEST_F(HapticSessionTest, TakesAPoseThatIsNotFiniteForNone) {
  press();
  const double before = force();
  const double bad = std::numeric_limits<double>::quiet_NaN();
  const auto noPose = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) {
      tick(Vec3(0.0, 0.0, bad));
      step();
    }
  };
  noPose(40);  // pose_timeout: 50 ms
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
  EXPECT_NEAR(force(), before, 0.02 * before);
  noPose(40);
  EXPECT_EQ(session_.status(), HapticStatus::PoseStale);
  EXPECT_EQ(force(), 0.0);
  EXPECT_TRUE(probe().device.allFinite());
}

TEST_F(HapticSessionTest, ASilentDeviceLeavesTheScene) {
  press();
  const auto silent = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) {
      tickWithoutPose();
      step();
    }
  };
  silent(990);
  EXPECT_TRUE(probe().present);
  silent(20);
  EXPECT_FALSE(probe().present);
  EXPECT_EQ(force(), 0.0);
}

TEST_F(HapticSessionTest, AJumpLetsGoAndBeginsAgain) {
  session_.setGrasp(true);
  press();
  EXPECT_TRUE(probe().grasps);
  for (int k = 0; k < 30; ++k) {
    tick(Vec3(1.0, 0.0, 0.0));
    step();
  }
  EXPECT_EQ(force(), 0.0);
  EXPECT_FALSE(probe().grasps);
  EXPECT_EQ(probe().device, Vec3(1.0, 0.0, 0.0));
  press();  // another jump, back to the sheet: the grasp stays open
  EXPECT_FALSE(probe().grasps);
  EXPECT_GT(force(), 0.1);
}

TEST_F(HapticSessionTest, LetsGoInAPause) {
  EXPECT_FALSE(session_.isPresent());
  session_.setGrasp(true);
  press();
  EXPECT_TRUE(session_.isPresent());
  EXPECT_EQ(session_.grasp(), GraspState::Holding);
  session_.pause(simulation_);
  EXPECT_EQ(session_.grasp(), GraspState::Open);
  press(1);
  EXPECT_FALSE(probe().grasps);
  session_.setGrasp(true);
  tick(Vec3(0.0, 0.0, 0.05));
  step();
  EXPECT_EQ(session_.grasp(), GraspState::Closed);  // with nothing in it
}

/// Moves the hand from above the sheet to below it within 0.5 s while no step is made. Criterion: the next
/// step does not move the sheet, which lies still. If all of the motion went into that step, it would supply
/// 2.3 J and drive the sheet at 41 m/s.
class MotionWithoutSteps : public HapticSessionTest {
 protected:
  static constexpr double kHeight = 0.05;  ///< of the hand, above the sheet and then below it [m]
  static constexpr double kStill = 0.01;   ///< a sheet at rest is slower [m/s]

  void rest() {
    for (int k = 0; k < 1000; ++k) {
      tick(Vec3(0.0, 0.0, kHeight));
      step();
    }
    work_ = simulation_.energy().work;
    ASSERT_LT(simulation_.maxSpeed(), kStill);
    ASSERT_TRUE(probe().present);
  }

  void move(bool paused) {
    constexpr int kTicks = 500;
    for (int k = 1; k <= kTicks; ++k) {
      tick(Vec3(0.0, 0.0, kHeight * (1.0 - 2.0 * k / kTicks)), paused);
      if (paused) session_.pause(simulation_);
    }
  }

  void stepQuietly() {
    step();
    EXPECT_EQ(probe().device, Vec3(0.0, 0.0, -kHeight));
    EXPECT_FALSE(probe().contact);
    EXPECT_NEAR(simulation_.energy().work, work_, 1e-6);
    EXPECT_LT(simulation_.maxSpeed(), kStill);
  }

  double work_ = 0.0;  ///< of the probe before the hand moves [J]
};

TEST_F(MotionWithoutSteps, InAPauseDoesNotPushTheCloth) {
  rest();
  move(true);
  stepQuietly();
}

TEST_F(MotionWithoutSteps, InAStallDoesNotPushTheCloth) {
  rest();
  session_.setGrasp(true);
  step();
  move(false);
  stepQuietly();
  EXPECT_EQ(session_.grasp(), GraspState::Closed);  // only a hand that jumps opens
}

TEST_F(MotionWithoutSteps, OfAHandThatRestsOnTheClothIsNone) {
  press();
  const double before = force();
  ASSERT_GT(before, 0.1);
  const Vec3 there = probe().device;
  for (int k = 0; k < 200; ++k) tick(there);  // a stall
  step();
  EXPECT_TRUE(probe().contact);
  for (int k = 0; k < 200; ++k) {
    tick(there, true);
    session_.pause(simulation_);
  }
  EXPECT_EQ(force(), 0.0);
  for (int k = 0; k < 1000; ++k) {
    tick(there);
    step();
  }
  EXPECT_NEAR(force(), before, 0.02 * before);  // the sheet still swings a little
}

TEST_F(MotionWithoutSteps, InAStepThatIsLatePushesTheCloth) {
  rest();
  // The force is not taken away before snapshot_timeout, 100 ms.
  for (int k = 1; k <= 99; ++k) tick(Vec3(0.0, 0.0, kHeight - 6e-4 * k));
  step();
  EXPECT_TRUE(probe().contact);
}

TEST_F(HapticSessionTest, AHandThatHoldsClothCatchesUpAtTwiceItsSpeed) {
  session_.setGrasp(true);
  press();
  ASSERT_EQ(session_.grasp(), GraspState::Holding);
  // The solver misses 50 ms, in which the hand lifts the cloth by 5 mm.
  const double start = probe().device.z(), moved = 1e-4;
  for (int k = 1; k <= 50; ++k) tick(Vec3(0.0, 0.0, start + k * moved));
  for (int k = 1; k <= 60; ++k) {
    // Hand and solver go on: after k steps the solver's hand has made the way of 2 k ticks.
    step();
    EXPECT_NEAR(probe().device.z() - start, std::min(2 * k, 49 + k) * moved, kRoundOff) << k;
    tick(Vec3(0.0, 0.0, start + (50 + k) * moved));
  }
  // It stays at most 0.1 s behind: of 0.4 s the first 0.3 s are made at once.
  const double later = probe().device.z(), far = 0.004;
  for (int k = 1; k < 400; ++k) tick(Vec3(0.0, 0.0, later + far));
  step();
  EXPECT_NEAR(probe().device.z() - later, 0.75 * far, kRoundOff);
}

/// A hand turns cloth in its grasp farther than the spring of the coupling answers. At each tick it feels the
/// solver's torque of the step before: k r² 0.5 rad at most, and the damper's share of the turn.
TEST(HapticSession, GivesTheTorqueOfTheCouplingAlsoWhereItsSpringIsSpent) {
  Scene scene = pinnedSheet();
  scene.probes[0].coupling_stiffness = 200.0;
  Simulation simulation(scene);
  HapticSession session(scene, 0, HapticOptions());
  session.setGrasp(true);
  constexpr double kTick = 1e-3, kRate = 2.0;  // [s], [rad/s]
  double time = 10.0;
  const auto turn = [&](double angle, double height) {
    time += kTick;
    const Wrench wrench = session.tick({Vec3(0.0, 0.0, height), rotationBy(angle * Vec3::UnitZ())}, time);
    session.beforeStep(simulation, time);
    simulation.step();
    session.afterStep(simulation, time);
    return wrench.torque;
  };
  for (int k = 0; k < 1000; ++k) turn(0.0, std::max(-0.005, 0.015 - 1e-4 * k));
  ASSERT_EQ(session.grasp(), GraspState::Holding);
  const double square = 0.03 * 0.03, spent = 200.0 * square * TurnSpring::kLargest;
  Vec3 solved = simulation.probe().torque;
  for (int k = 1; k <= 1500; ++k) {
    const Vec3 torque = turn(std::min(1.2, kRate * kTick * k), -0.005);
    // In a tick the hand turns on by kRate kTick, with the damper's c r² kRate at most.
    const double change = (200.0 * kTick + 1.0) * square * kRate;
    ASSERT_LT((torque - solved).norm(), change + 0.02 * spent) << k;
    solved = simulation.probe().torque;
  }
  EXPECT_NEAR(solved.norm(), spent, 0.01 * spent);
}

/// A device whose poses stop for longer than `probe_timeout` must not find its hand closed, also where no
/// step was made meanwhile.
TEST_F(HapticSessionTest, AHandThatWasSilentWhileNoStepWasMadeIsOpen) {
  session_.setGrasp(true);
  press();
  ASSERT_EQ(session_.grasp(), GraspState::Holding);
  const Vec3 there = probe().device;
  const auto silent = [&](double timeouts) {
    for (int k = 0; k < timeouts * options_.probe_timeout / kTick; ++k) tickWithoutPose();
  };
  silent(0.9);
  tick(there);
  step();
  EXPECT_EQ(session_.grasp(), GraspState::Holding);
  silent(1.1);
  tick(there + Vec3(0.0, 0.0, 0.02));
  step();
  EXPECT_EQ(session_.grasp(), GraspState::Open);
  EXPECT_FALSE(probe().contact);
}

TEST_F(HapticSessionTest, AHandThatHoldsClothInSlowMotionIsNotLate) {
  session_.setGrasp(true);
  press();
  ASSERT_EQ(session_.grasp(), GraspState::Holding);
  // Each step of 1 ms takes 4 ms. One such step might be a late one; from the second on it is slow motion.
  double height = probe().device.z();
  for (int k = 1; k <= 20; ++k) {
    for (int l = 0; l < 4; ++l) tick(Vec3(0.0, 0.0, height += 1e-4));
    step();
    if (k == 1) continue;
    EXPECT_EQ(probe().device.z(), height) << k;
  }
}

TEST_F(HapticSessionTest, AHandThatJumpsWhileItCatchesUpLetsGo) {
  session_.setGrasp(true);
  press();
  ASSERT_EQ(session_.grasp(), GraspState::Holding);
  const double start = probe().device.z();
  for (int k = 1; k <= 50; ++k) tick(Vec3(0.0, 0.0, start + k * 1e-4));
  step();
  ASSERT_EQ(session_.grasp(), GraspState::Holding);
  // No hand moves by 0.3 m in the tick since the newest pose; in the 50 ms by which the solver's is late it
  // might (isJump()).
  tick(Vec3(0.0, 0.0, start + 0.3));
  step();
  EXPECT_EQ(session_.grasp(), GraspState::Open);
}

TEST_F(HapticSessionTest, TakesOtherOptionsWhileItRuns) {
  press();
  HapticOptions other = session_.options();
  other.coupling_stiffness *= 0.5;
  other.coupling_damping *= 2.0;
  other.probe_timeout = 0.2;
  session_.setOptions(other);
  press();
  const ProbeOptions& coupling = simulation_.scene().probes[0];
  EXPECT_EQ(coupling.coupling_stiffness, other.coupling_stiffness);
  EXPECT_EQ(coupling.coupling_damping, other.coupling_damping);
  const double expected = other.coupling_stiffness * (probe().proxy - probe().device).norm();
  EXPECT_NEAR(force(), expected, 0.02 * expected);  // the sheet still swings a little
  const auto silent = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) {
      tickWithoutPose();
      step();
    }
  };
  silent(190);
  EXPECT_TRUE(session_.isPresent());
  silent(20);
  EXPECT_FALSE(session_.isPresent());
}

TEST_F(HapticSessionTest, APoseThatIsNotNewerIsNone) {
  press();
  const double sent = time_;
  for (int k = 0; k < 10; ++k) {
    session_.setPose({Vec3(0.0, 0.0, 0.05), Quat::Identity()}, sent - 1e-3 * k);
    tickWithoutPose();
    step();
  }
  EXPECT_EQ(probe().device, Vec3(0.0, 0.0, -0.005));
  session_.setPose({Vec3(0.0, 0.0, 0.05), Quat::Identity()}, time_);
  tickWithoutPose();
  step();
  EXPECT_EQ(probe().device, Vec3(0.0, 0.0, 0.05));
}

/// Times of another clock would never grow old, or keep the poses of this one out.
TEST_F(HapticSessionTest, APoseOfAnotherClockIsNone) {
  press();
  session_.setPose({Vec3(0.0, 0.0, -0.005), Quat::Identity()}, time_ + 3600.0);
  for (int k = 0; k < 30; ++k) {  // ramp_time: 20 ms
    tickWithoutPose();
    step();
  }
  EXPECT_EQ(session_.status(), HapticStatus::NoPose);
  EXPECT_EQ(force(), 0.0);
  EXPECT_FALSE(session_.isPresent());
  tick(Vec3(0.0, 0.0, 0.05));
  step();
  tick(Vec3(0.0, 0.0, 0.05));
  EXPECT_EQ(session_.status(), HapticStatus::Free);
  EXPECT_TRUE(session_.isPresent());
}

TEST_F(HapticSessionTest, ASolverWithAnotherClockGivesNoForce) {
  for (int k = 0; k < 200; ++k) {
    tick(Vec3(0.0, 0.0, 0.015 - 1e-4 * k));
    const double late = time_ + 3600.0;
    session_.beforeStep(simulation_, late);
    simulation_.step();
    session_.afterStep(simulation_, late);
  }
  EXPECT_EQ(session_.status(), HapticStatus::SnapshotStale);
  EXPECT_EQ(force(), 0.0);
  EXPECT_FALSE(session_.isPresent());
}

TEST_F(HapticSessionTest, TakesALengthOfAStepAsTheSimulationDoes) {
  tick(Vec3(0.0, 0.0, 0.05));
  session_.beforeStep(simulation_, time_, 0);
  simulation_.step(0);
  EXPECT_TRUE(probe().present);
}

TEST_F(HapticSessionTest, HoldsNoEnergyWithoutContact) {
  EXPECT_EQ(session_.energy(), 0.0);
  press();
  EXPECT_GT(session_.energy(), 0.0);
  for (int k = 0; k < 130; ++k) tick(Vec3(0.0, 0.0, -0.005));
  EXPECT_EQ(session_.status(), HapticStatus::SnapshotStale);
  EXPECT_EQ(session_.energy(), 0.0);
}

TEST_F(HapticSessionTest, BeginsAgainAfterAReset) {
  press();
  simulation_.reset();
  session_.restart(simulation_);
  for (int k = 0; k < 30; ++k) tick(Vec3(0.0, 0.0, -0.005));
  EXPECT_EQ(session_.status(), HapticStatus::NoSnapshot);
  EXPECT_EQ(force(), 0.0);
  EXPECT_FALSE(probe().present);
  press();
  EXPECT_GT(force(), 0.1);
}

TEST_F(HapticSessionTest, RefusesWhatItCannotServe) {
  EXPECT_THROW(HapticSession(simulation_.scene(), -1), InputError);
  EXPECT_THROW(HapticSession(simulation_.scene(), 1), InputError);
  HapticOptions options;
  options.max_force = 0.0;
  EXPECT_THROW(HapticSession(simulation_.scene(), 0, options), InputError);
}

/// Bad limits and couplings are refused on the device's thread, before anything changes.
TEST_F(HapticSessionTest, RefusesOtherOptionsThatAreBad) {
  press();
  const auto refuse = [&](double HapticOptions::*option, double value) {
    HapticOptions bad = session_.options();
    bad.max_torque = 0.0;  // a good change beside the bad one
    bad.*option = value;
    EXPECT_THROW(session_.setOptions(bad), InputError) << value;
  };
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0}) {
    for (const auto option : {&HapticOptions::max_force, &HapticOptions::max_force_rate,
                              &HapticOptions::ramp_time, &HapticOptions::coupling_stiffness})
      refuse(option, value);
  }
  refuse(&HapticOptions::coupling_damping, -1.0);
  for (const double unit : {std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0})
    EXPECT_THROW(session_.setOptions(session_.options(), unit), InputError) << unit;
  EXPECT_EQ(session_.options().max_torque, HapticOptions().max_torque);
  const double before = force();
  press(50);  // each tick checks the limits
  EXPECT_EQ(simulation_.scene().probes[0].coupling_stiffness, session_.options().coupling_stiffness);
  EXPECT_GT(before, 0.1);
}

/// A hand that pushes an admittance device.
class AdmittanceSessionTest : public ::testing::Test {
 protected:
  static constexpr double kTick = 1e-3;  ///< [s]
  static constexpr double kPush = 1.0;   ///< [N]

  explicit AdmittanceSessionTest(const Scene& scene = pinnedSheet())
      : simulation_(scene), session_(simulation_.scene(), 0, options()) {}

  static HapticOptions options() {
    HapticOptions options;
    options.admittance.start = Vec3(0.0, 0.0, 0.02);
    options.admittance.workspace_low.z() = -0.1;
    return options;
  }

  void step() {
    session_.beforeStep(simulation_, time_);
    simulation_.step();
    session_.afterStep(simulation_, time_);
  }

  void push(int ticks, double force = -kPush) {
    for (int k = 0; k < ticks; ++k) {
      target_ = session_.tick(Vec3(0.0, 0.0, force), time_ += kTick);
      step();
    }
  }

  void letGo(int ticks) {
    for (int k = 0; k < ticks; ++k) {
      target_ = session_.tick(time_ += kTick);
      step();
    }
  }

  Simulation simulation_;
  AdmittanceSession session_;
  Pose target_;
  double time_ = 10.0;  ///< [s]
};

TEST_F(AdmittanceSessionTest, HandAndClothBalanceAtTheTool) {
  push(3000);
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
  EXPECT_NEAR(session_.reaction().force.z(), kPush, 0.02 * kPush);  // the sheet still swings a little
  EXPECT_LT(target_.position.z(), 0.0);
  // The simulation has the place at which the last tick began.
  const double way = (simulation_.probe().device - target_.position).norm();
  EXPECT_LE(way, options().admittance.max_speed * kTick);
}

/// A tool that appears in the cloth feels nothing. A push would drive it through what the cloth lies on.
TEST_F(AdmittanceSessionTest, AToolInsideTheClothOnlyMovesOut) {
  const double radius = simulation_.scene().probes[0].radius, start = 0.4 * radius;
  session_.setPose({Vec3(0.0, 0.0, start), Quat::Identity()}, time_);
  push(100);
  EXPECT_EQ(session_.status(), HapticStatus::Inside);
  const double stopped = target_.position.z();
  EXPECT_NEAR(stopped, start, 1e-4);  // until the second step it may fall, and it brakes
  push(10000);
  EXPECT_EQ(session_.status(), HapticStatus::Inside);
  EXPECT_NEAR(target_.position.z(), stopped, 1e-6) << "it does not creep";
  push(200, kPush);
  EXPECT_GT(target_.position.z(), radius);
  EXPECT_EQ(session_.status(), HapticStatus::Free);
  push(2000);
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
}

/// A hand presses a tool on cloth that lies on a block, so hard that the tool is deeper in it than its
/// radius.
class PressedTool : public AdmittanceSessionTest {
 protected:
  static constexpr double kPress = -3.2, kStiffness = 220.0;  ///< [N], [N/m]
  static constexpr double kTop = 0.04;                        ///< of the block [m]

  static Scene scene() {
    LinearFabric linear;
    linear.rigidity = 1e-5;
    Scene scene = sheetScene(makeFabric(linear), 17, 17, 0.16, 0.16);
    scene.cloth.pose.position.z() = kTop + 0.004;
    scene.air_damping = 5.0;
    Obstacle block;
    block.shape = Shape::Box;
    block.size = Vec3(0.2, 0.2, kTop);
    block.pose.position.z() = 0.5 * kTop;
    scene.obstacles.push_back(block);
    scene.probes[0].coupling_stiffness = kStiffness;
    return scene;
  }

  PressedTool() : AdmittanceSessionTest(scene()) {
    session_.setPose({Vec3(0.0, 0.0, kTop + 0.03), Quat::Identity()}, time_);
    push(2000, kPress);
    pressed_ = tool();
    EXPECT_EQ(session_.status(), HapticStatus::Contact);
    EXPECT_LT(pressed_, kTop - 0.004) << "its centre is in the block";
  }

  void stall(int ticks) {
    for (int k = 0; k < ticks; ++k) target_ = session_.tick(Vec3(0.0, 0.0, kPress), time_ += kTick);
  }
  double tool() const { return target_.position.z(); }

  double pressed_ = 0.0;
};

TEST_F(PressedTool, GoesNoDeeperAfterAReset) {
  simulation_.reset();
  session_.restart(simulation_);
  push(1000, kPress);  // the last reaction fades
  const double held = tool();
  EXPECT_GT(held, pressed_ - 1e-6);
  push(3000, kPress);
  EXPECT_NEAR(tool(), held, 1e-6);
  push(600, 0.5);
  EXPECT_GT(tool(), kTop + 0.02) << "it gets out";
}

TEST_F(PressedTool, GoesNoDeeperWhereTheHandWasSilentUntilTheProbeLeft) {
  letGo(1300);
  EXPECT_FALSE(session_.isPresent());
  push(3000, kPress);
  EXPECT_GT(tool(), pressed_ - 1e-4);
}

/// SIGSTOP: neither thread runs. Then steps may come before the first tick, and find no force for long.
TEST_F(PressedTool, GoesNoDeeperWhereTheProcessStoodStill) {
  for (const int steps : {0, 1, 10}) {
    time_ += 2.5 * session_.options().probe_timeout;
    for (int k = 0; k < steps; ++k) step();
    push(1000, kPress);
    EXPECT_GT(tool(), pressed_ - 1e-4) << steps << " steps before the first tick";
  }
}

TEST_F(PressedTool, IsPressedHarderAfterAShortSilence) {
  push(1000, 0.5 * kPress);
  const double lightly = tool();
  letGo(100);
  push(2000, kPress);
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
  EXPECT_NEAR(tool(), pressed_, 0.1 * (lightly - pressed_)) << "as before";
}

/// A tool moves on while no steps are made, until its snapshot is too old. It must not pass the cloth.
TEST_F(PressedTool, MeetsTheClothThatItPassedInAStall) {
  push(400, 1.0);
  while (tool() > kTop + 0.03) push(1, kPress);
  ASSERT_EQ(session_.status(), HapticStatus::Free);
  stall(300);
  EXPECT_LT(tool(), kTop) << "it has passed the cloth";
  push(3000, kPress);
  EXPECT_EQ(session_.status(), HapticStatus::Contact);
  EXPECT_NEAR(tool(), pressed_, 0.1 * (kTop - pressed_));
}

TEST_F(AdmittanceSessionTest, StartsAndTurnsWithTheDevice) {
  const Pose device{Vec3(0.01, 0.0, 0.03), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()))};
  session_.setPose(device, time_);
  letGo(10);
  EXPECT_FALSE(session_.hasStarted());
  EXPECT_FALSE(session_.isPresent());
  EXPECT_EQ(session_.status(), HapticStatus::NoForce);
  EXPECT_EQ(target_.position, device.position);
  push(10);
  EXPECT_TRUE(session_.hasStarted());
  EXPECT_TRUE(session_.isPresent());
  EXPECT_LT(target_.position.z(), device.position.z());
  EXPECT_TRUE(session_.orientation().isApprox(device.orientation, kRoundOff));
}

/// A device that comes back after a silence may have been moved. A command at the old place would move it
/// there at once, whatever the tool's limits of speed are.
class ReturningTool : public AdmittanceSessionTest {
 protected:
  static constexpr double kFar = 0.2;  ///< [m]

  ReturningTool() {
    session_.setPose(at(0.0), time_);
    push(200, 0.5);
    old_ = target_.position;
  }

  Pose at(double x) const { return {Vec3(x, 0.0, 0.05), Quat::Identity()}; }
  double silence() const { return 1.5 * session_.options().probe_timeout; }

  /// The hand lets go for a while, in which the device says where it is.
  void letGoAt(double x, double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kTick); ++k) {
      session_.setPose(at(x), time_);
      letGo(1);
    }
  }

  void expectStartsAt(double x) {
    push(1, 0.5);
    EXPECT_LT((target_.position - at(x).position).norm(), 1e-6);
    push(2, 0.5);  // the solver takes the place of the tick before
    EXPECT_LT((simulation_.probe().device - target_.position).norm(), 1e-4) << "nor on the way there";
    EXPECT_FALSE(simulation_.probe().contact);
  }

  Vec3 old_;
};

TEST_F(ReturningTool, IsWhereItsPosesComeBack) {
  letGo(static_cast<int>(silence() / kTick));
  EXPECT_LT((target_.position - old_).norm(), 0.05) << "it has stopped";
  session_.setPose(at(kFar), time_);
  letGo(1);
  expectStartsAt(kFar);
}

TEST_F(ReturningTool, IsWhereTheDeviceIsWhenForcesComeBack) {
  session_.setPose(at(0.0), time_);
  letGoAt(kFar, silence());
  EXPECT_LT((target_.position - old_).norm(), 0.05) << "nothing moves a device whose force is not known";
  expectStartsAt(kFar);
}

/// A device may come back near the place where its tool pressed the cloth, and be free there.
TEST_F(ReturningTool, IsNotHeldByTheClothWhereItWas) {
  push(3000);
  ASSERT_EQ(session_.status(), HapticStatus::Contact);
  push(static_cast<int>(silence() / kTick));  // poses are missing
  const Vec3 free(0.095, 0.0, -0.02);         // beside the sheet
  session_.setPose({free, Quat::Identity()}, time_);
  push(1, 0.0);
  ASSERT_LT((target_.position - free).norm(), 1e-6);
  push(1000);
  EXPECT_LT(target_.position.z(), free.z() - 0.02);
}

TEST_F(ReturningTool, StaysAfterAShortSilenceAndWhereTheDeviceFollowed) {
  letGo(100);
  session_.setPose(at(kFar), time_);
  letGo(1);
  EXPECT_LT((target_.position - old_).norm(), 0.05) << "poses may be rare";
  const double here = target_.position.x();
  letGo(static_cast<int>(silence() / kTick));
  const Vec3 stopped = target_.position;
  session_.setPose({stopped + Vec3(3e-3, 0.0, 0.0), Quat::Identity()}, time_);
  push(1, 0.5);
  EXPECT_NEAR(target_.position.x(), here, 1e-6) << "its controller is 3 mm off";
}

TEST_F(AdmittanceSessionTest, RefusesOtherOptionsThatAreBad) {
  HapticOptions bad = session_.options();
  bad.admittance.mass = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(session_.setOptions(bad), InputError);
  bad = session_.options();
  bad.admittance.workspace_high = bad.admittance.workspace_low;
  EXPECT_THROW(session_.setOptions(bad), InputError);
  EXPECT_EQ(session_.options().admittance.mass, options().admittance.mass);
}

TEST_F(AdmittanceSessionTest, StopsWithoutForcesAndLeavesTheScene) {
  push(200);
  EXPECT_FALSE(session_.isAtRest());
  const AdmittanceOptions tool = options().admittance;
  letGo(static_cast<int>((tool.force_timeout + tool.max_speed / tool.max_acceleration) / kTick) + 2);
  EXPECT_TRUE(session_.isAtRest());
  EXPECT_EQ(session_.status(), HapticStatus::ForceStale);
  EXPECT_TRUE(session_.isPresent());
  letGo(1000);  // probe_timeout: 1 s
  EXPECT_FALSE(session_.isPresent());
}

TEST_F(AdmittanceSessionTest, AForceOfAnotherClockIsNone) {
  push(200);
  session_.setForce(Vec3(0.0, 0.0, -kPush), time_ + 0.3);
  const AdmittanceOptions tool = options().admittance;
  letGo(static_cast<int>(tool.max_speed / tool.max_acceleration / kTick) + 2);
  EXPECT_EQ(session_.status(), HapticStatus::NoForce);
  EXPECT_TRUE(session_.isAtRest());
  const Pose before = target_;
  letGo(400);
  EXPECT_EQ(target_.position, before.position);
}

TEST(StepInterval, IsTheMeanOfTheTimeBetweenStepsWithoutPauses) {
  StepInterval interval;
  double now = 5.0;
  const auto begin = [&](double passed) { return interval.begin(now += passed, 1e-3, 0.1); };
  EXPECT_TRUE(begin(0.0));
  EXPECT_EQ(interval.seconds(), 1e-3);
  for (int k = 0; k < 200; ++k) begin(3e-3);
  EXPECT_NEAR(interval.seconds(), 3e-3, 1e-9);  // 0.9^200 of 2 ms
  EXPECT_FALSE(begin(3e-3));
  EXPECT_TRUE(begin(10.0));
  EXPECT_NEAR(interval.seconds(), 3e-3, 1e-9);
  interval.interrupt();
  EXPECT_TRUE(begin(0.05));
  EXPECT_NEAR(interval.seconds(), 3e-3, 1e-9);
  for (int k = 0; k < 200; ++k) begin(1e-5);
  EXPECT_EQ(interval.seconds(), 1e-3);  // a solver that catches up is no faster than the clock
}

}  // namespace
}  // namespace haptic_cloth::haptic_session_test
