/// Model of one probe: how its proxy follows the device, and its energy balance.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "contact/proxy.h"
#include "haptic_cloth/passivity.h"
#include "haptics/probe_tracker.h"
#include "support/straight.h"

namespace haptic_cloth::probe_model_test {
namespace {

constexpr double kTick = 1e-3;

ProbeReport reportAt(const Vec3& device, const Vec3& proxy) {
  ProbeReport report;
  report.present = report.contact = true;
  report.device = device;
  report.proxy = proxy;
  return report;
}

/// Poses that move randomly by up to 0.1 mm per step in each direction.
std::vector<Vec3> poses(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(-1e-4, 1e-4);
  std::vector<Vec3> poses(1, Vec3::Zero());
  while (static_cast<int>(poses.size()) < count)
    poses.push_back(poses.back() + Vec3(step(random), step(random), step(random)));
  return poses;
}

TEST(ProbeTracker, LearnsALinearAnswer) {
  // Elastic cloth behind a spring: symmetric, with eigenvalues 0.1, 0.5 and 0.9 on tilted axes.
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const Mat3 axes = turn.toRotationMatrix();
  const Mat3 truth = axes * Vec3(0.1, 0.5, 0.9).asDiagonal() * axes.transpose();
  ProbeTracker tracker;
  for (const Vec3& device : poses(200)) {
    tracker.update(reportAt(device, truth * device), DeviceSample(), kTick, 0.0);
  }
  // A secant in a random direction leaves at most about 0.9 of the error; 200 secants leave
  // 0.9^200.
  EXPECT_LT((tracker.follow().topLeftCorner<3, 3>() - truth).norm(), 1e-6);
}

/// Criterion: the square of force over estimated error, which fades to 1/e in 20 ms (probe_tracker.cpp).
TEST(ProbeTracker, TrustsAForceThatExceedsItsError) {
  ProbeTracker tracker;
  ProbeReport report = reportAt(Vec3::Zero(), Vec3::Zero());
  report.force = Vec3(0.6, 0.0, 0.8);
  const auto trust = [&](double error) {
    report.force_error = error;
    return tracker.update(report, DeviceSample(), kTick, 0.0).trust;
  };
  EXPECT_EQ(trust(0.0), 1.0);
  EXPECT_EQ(trust(0.99), 1.0);
  EXPECT_NEAR(trust(2.0), 0.25, 1e-12) << "at once";
  for (int k = 0; k < 9; ++k) trust(0.5);
  EXPECT_NEAR(trust(0.5), 0.25 * std::exp(1.0), 1e-9) << "after 10 ms";
  for (int k = 0; k < 10; ++k) trust(0.5);
  EXPECT_EQ(trust(0.5), 1.0);
  report.force.setZero();
  EXPECT_EQ(trust(0.1), 0.0);
  tracker.reset();
  EXPECT_EQ(trust(0.0), 1.0) << "no force has no error";
}

TEST(ProbeTracker, LearnsHowTurnsAndMovesGoTogether) {
  // Symmetric, with eigenvalues from 0.1 to 0.9 and axes between moves and turns.
  constexpr double kRadius = 0.04;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto some = [&] { return Vec6(Vec6::NullaryExpr([&] { return number(random); })); };
  Mat6 axes;
  for (int c = 0; c < 6; ++c) axes.col(c) = some();
  axes = Eigen::HouseholderQR<Mat6>(axes).householderQ();
  const Mat6 truth = axes * Vec6::LinSpaced(0.1, 0.9).asDiagonal() * axes.transpose();
  ProbeTracker tracker;
  ProbeReport report = reportAt(Vec3::Zero(), Vec3::Zero());
  report.turn_radius = kRadius;
  DeviceSample device;
  for (int k = 0; k < 600; ++k) {
    const Vec6 moved = 1e-4 * some(), followed = truth * moved;
    report.device += moved.head<3>();
    report.proxy += followed.head<3>();
    device.orientation = rotationBy(moved.tail<3>() / kRadius) * device.orientation;
    report.orientation = rotationBy(followed.tail<3>() / kRadius) * report.orientation;
    tracker.update(report, device, kTick, 0.0);
  }
  // 0.95^600 of the error is left, by the same reasoning as above.
  EXPECT_LT((tracker.follow() - truth).norm(), 1e-6);
  // A grip that opens knows no more of turns, but all of moves.
  report.turn_radius = 0.0;
  const Mat6 follow = tracker.update(report, device, kTick, 0.0).follow;
  Mat6 expected = Mat6::Identity();
  expected.topLeftCorner<3, 3>() = truth.topLeftCorner<3, 3>();
  EXPECT_LT((follow - expected).norm(), 1e-6);
}

TEST(ProbeTracker, StaysAPassiveAnswer) {
  // Proxies that run away, move against the device, or are not finite.
  for (const double factor : {-3.0, 5.0, 1e200}) {
    ProbeTracker tracker;
    for (const Vec3& device : poses(100)) {
      tracker.update(reportAt(device, factor * device), DeviceSample(), kTick, 0.0);
      const Mat6& follow = tracker.follow();
      ASSERT_TRUE(follow.allFinite());
      ASSERT_LT((follow - follow.transpose()).norm(), 1e-12);
      const Vec6 eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(follow).eigenvalues();
      ASSERT_GE(eigenvalues.minCoeff(), -1e-9);
      ASSERT_LE(eigenvalues.maxCoeff(), 1.0 + 1e-9);
    }
  }
}

TEST(ProbeTracker, ForgetsWithoutContact) {
  ProbeTracker tracker;
  for (const Vec3& device : poses(200))
    tracker.update(reportAt(device, Vec3::Zero()), DeviceSample(), kTick, 0.0);
  EXPECT_LT((tracker.follow().topLeftCorner<3, 3>().norm()), 1e-6);
  ProbeReport free = reportAt(Vec3::Zero(), Vec3::Zero());
  free.contact = false;
  const ProbeSnapshot snapshot = tracker.update(free, DeviceSample(), kTick, 0.05);
  EXPECT_EQ(snapshot.follow, Mat6(Mat6::Identity()));
  EXPECT_EQ(snapshot.drift, Vec6(Vec6::Zero()));
}

PassivityOptions bare() {
  PassivityOptions options;
  options.device_damping = 0.0;
  options.loop_delay = 0.0;
  return options;
}

/// Swings by 2 mm, 5 times a second, on the sampled and held force -k x. @return the energy at the
/// end [J]
double swing(PassivityController& controller, double stiffness, int cycles, double held) {
  for (int k = 0; k < cycles * 200; ++k) {
    const double x = 2e-3 * std::sin(2 * EIGEN_PI * 5.0 * k * kTick);
    controller.observe(straight(x, 0, 0), {0.0, k == 0 ? 0.0 : held}, 0.0);
    controller.sent(straight(-stiffness * x, 0, 0));
  }
  return controller.energy();
}

TEST(PassivityController, FindsTheEnergyThatSamplingMakes) {
  // A sampled spring lags by half a tick and creates π k (ω T/2) A² per cycle [Colgate & Schenkel
  // 1994], to second order in ω T = 0.03.
  PassivityController controller(bare(), kTick);
  const double omega = 2 * EIGEN_PI * 5.0, amplitude = 2e-3;
  const double made = EIGEN_PI * 400.0 * 0.5 * omega * kTick * amplitude * amplitude;
  EXPECT_NEAR(swing(controller, 400.0, 10, 1.0), -10 * made, 0.02 * 10 * made);
}

TEST(PassivityController, FindsTheEnergyThatADelayMakes) {
  // The delay t_d adds to T/2.
  PassivityOptions options = bare();
  options.loop_delay = 0.0025;
  PassivityController controller(options, kTick);
  const double omega = 2 * EIGEN_PI * 5.0, amplitude = 2e-3;
  const double made = EIGEN_PI * 400.0 * omega * (0.5 * kTick + 0.0025) * amplitude * amplitude;
  EXPECT_NEAR(swing(controller, 400.0, 10, 1.0), -10 * made, 0.02 * 10 * made);
}

/// Energy [J] that is lost in ticks of 0.1 mm under these forces, computed here from all of them.
struct Ticked {
  double counted, expected;
};

Ticked tickedFor(double rate, double delay, int ticks) {
  PassivityOptions options = bare();
  options.loop_delay = delay;
  PassivityController controller(options, 1.0 / rate);
  const double held = 100.0, way = 1e-4;
  const auto force = [](int k) { return 1.0 + std::sin(0.7 * k); };
  const int late = 1 + static_cast<int>(std::lround(delay * rate));
  double expected = held;
  for (int k = 0; k < ticks; ++k) {
    controller.observe(straight(k * way, 0, 0), {held, 0.0}, 0.0);
    controller.sent(straight(force(k), 0, 0));
    if (k >= late) expected -= force(k - late) * way;
  }
  return {controller.energy(), expected};
}

TEST(PassivityController, KnowsTheForceOfTheLongestDelayAtEveryRate) {
  for (const double rate : {100.0, 1000.0, 4000.0, 10000.0}) {
    for (const double delay : {0.0, 0.01, 0.02, 0.1}) {
      const Ticked energy = tickedFor(rate, delay, 3000);
      EXPECT_NEAR(energy.counted, energy.expected, 1e-9) << rate << " Hz, " << delay << " s";
    }
  }
}

TEST(PassivityController, CountsAndDampsTurnsAsMoves) {
  // The same buzz along x and about y, where no damping of the hand is sure.
  const auto buzz = [](const PassivityOptions& options, int axis) {
    PassivityController controller(options, kTick);
    for (int k = 0; k < 100; ++k) {
      const double x = 2e-3 * std::sin(0.3 * k);
      controller.observe(x * Vec6::Unit(axis), {0.0, k == 0 ? 0.0 : 1.0}, 0.0);
      controller.sent(-400.0 * x * Vec6::Unit(axis));
    }
    return controller;
  };
  const PassivityController moved = buzz(bare(), 0), turned = buzz(bare(), 4);
  EXPECT_LT(moved.energy(), -1e-4);
  EXPECT_NEAR(turned.energy(), moved.energy(), 1e-15);
  EXPECT_GT(std::abs(moved.damping()[0]), 0.1);
  EXPECT_NEAR(turned.damping()[4], moved.damping()[0], 1e-12);
  PassivityOptions sure = bare();
  sure.device_damping = 10.0;
  EXPECT_GT(buzz(sure, 0).energy(), 0.0);
  EXPECT_NEAR(buzz(sure, 4).energy(), moved.energy(), 1e-15);
}

/// The memory of forces is overwritten hundreds of times, that of positions 100,000 times.
TEST(PassivityController, CountsForHoursAsAtTheStart) {
  const Ticked energy = tickedFor(1000.0, 0.02, 500000);
  EXPECT_NEAR(energy.counted, energy.expected, 1e-8) << "sums of 500,000 terms of 1e-4 J";
}

TEST(PassivityController, CountsOnTheHandsDamping) {
  // With b > K T/2 there is no debt at the end of a cycle.
  PassivityOptions options = bare();
  options.device_damping = 0.3;
  PassivityController controller(options, kTick);
  EXPECT_GE(swing(controller, 400.0, 10, 1.0), 0.0);
}

TEST(PassivityController, LongFrictionFillsNoStore) {
  // 1 N against 0.2 m/s for 10 s puts in 2 J. Only the energy that coupling and cloth hold may come
  // out.
  PassivityController controller(bare(), kTick);
  for (int k = 0; k < 10000; ++k) {
    controller.observe(straight(0.2 * k * kTick, 0, 0), {0.0, 0.003}, 0.0);
    controller.sent(straight(-1.0, 0, 0));
  }
  EXPECT_EQ(controller.energy(), 0.003);
  PassivityOptions small = bare();
  small.store = 0.001;
  PassivityController bounded(small, kTick);
  bounded.observe(Vec6::Zero(), {0.0, 0.0}, 0.0);
  bounded.sent(straight(-1.0, 0, 0));
  bounded.observe(straight(0.5, 0, 0), {0.0, 1.0}, 0.0);
  EXPECT_EQ(bounded.energy(), 0.001);
  // The energy of the coupling's own spring adds to the store, because it is known exactly.
  bounded.sent(straight(-1.0, 0, 0));
  bounded.observe(straight(1.0, 0, 0), {0.002, 1.0}, 0.0);
  EXPECT_EQ(bounded.energy(), 0.003);
}

TEST(PassivityController, ATickInWhichTheClothSeemsStiffCostsNothing) {
  // The cloth holds 10 mJ. At a tick it seems to hold a quarter, and then it gives 8 mJ back. What may come
  // out falls to 1/e in 5 ms, but not below what it seems to hold.
  PassivityController controller(bare(), kTick);
  controller.observe(Vec6::Zero(), {0.0, 0.01}, 0.0);
  controller.observe(Vec6::Zero(), {0.0, 0.0025}, 0.0);
  controller.sent(straight(1.0, 0, 0));
  controller.observe(straight(0.008, 0, 0), {0.0, 0.01}, 0.0);
  EXPECT_NEAR(controller.energy(), 0.01 * std::exp(-kTick / 0.005) - 0.008, 1e-12);
  PassivityController held(bare(), kTick);
  held.observe(Vec6::Zero(), {0.0, 0.01}, 0.0);
  for (int k = 0; k < 4; ++k) held.observe(Vec6::Zero(), {0.0, 0.0025}, 0.0);
  EXPECT_NEAR(held.energy(), 0.01 * std::exp(-0.8), 1e-12);
  for (int k = 0; k < 1000; ++k) held.observe(Vec6::Zero(), {0.0, 0.0025}, 0.0);
  EXPECT_EQ(held.energy(), 0.0025);
}

TEST(PassivityController, PaysWithABoundedDamperAndAWeakerForce) {
  const PassivityOptions options = bare();
  PassivityController controller(options, kTick);
  EXPECT_EQ(controller.gain(), 1.0);
  EXPECT_EQ(controller.damping(), Vec6(Vec6::Zero()));
  controller.observe(Vec6::Zero(), {0.0, 0.0}, 0.0);
  controller.sent(straight(1.0, 0, 0));
  // 1 N over this distance: a debt of exactly options.debt.
  controller.observe(straight(options.debt, 0, 0), {0.0, 1.0}, 0.0);
  EXPECT_NEAR(controller.energy(), -options.debt, 1e-15);
  EXPECT_NEAR(controller.gain(), 0.5, 1e-12);
  EXPECT_NEAR(controller.damping().x(), -options.damping * controller.velocity().x(), 1e-12);
  // At rest the damper exerts no force, however large the debt.
  for (int k = 0; k < 10; ++k) {
    controller.sent(straight(1.0, 0, 0));
    controller.observe(straight(options.debt, 0, 0), {0.0, 1.0}, 0.0);
  }
  EXPECT_EQ(controller.damping(), Vec6(Vec6::Zero()));
  EXPECT_LT(controller.energy(), 0.0);
}

TEST(PassivityController, AFaultLeavesWhatIsHeld) {
  PassivityController controller(bare(), kTick);
  controller.reset();
  controller.observe(Vec6::Zero(), {0.0, 0.003}, 0.0);
  EXPECT_EQ(controller.energy(), 0.003);
  controller.observe(Vec6::Zero(), {0.0, 0.0}, 0.0);
  EXPECT_EQ(controller.energy(), 0.0);
}

/// 1 N pulls the hand along for 1 m. The cloth gives all of that, or all but 10 μJ on the last millimetre.
TEST(PassivityController, WhatTheClothGivesIsNoDebt) {
  constexpr double kWay = 1e-3, kMissing = 1e-5;
  for (const double missing : {0.0, kMissing}) {
    PassivityController controller(bare(), kTick);
    for (int k = 0; k <= 1000; ++k) {
      controller.observe(straight(k * kWay, 0, 0), {0.0, 0.0}, k == 1000 ? missing - kWay : -kWay);
      controller.sent(straight(1.0, 0, 0));
    }
    EXPECT_NEAR(controller.energy(), -missing, 1e-12);
    EXPECT_NEAR(controller.gain(), bare().debt / (bare().debt + missing), 1e-9);
  }
}

/// 10 mJ are owed where the spring holds 50 mJ. If the gain followed the debt a tick late, it would never
/// settle: too low, it takes so much from the spring that nothing is owed any more.
TEST(PassivityController, TheGainIsSteadyOverAStretchedSpring) {
  constexpr double kSpring = 0.05, kDebt = 0.01;
  PassivityController controller(bare(), kTick);
  double taken = 0.0, least = 1.0, most = 0.0;  // by the last change of the gain [J]
  for (int k = 0; k < 200; ++k) {
    const double before = controller.gain();
    controller.observe(straight(k == 0 ? 0.0 : kDebt, 0, 0), {0.0, 0.0, kSpring}, taken);
    controller.sent(straight(k == 0 ? 1.0 : 0.0, 0, 0));
    taken = (controller.gain() - before) * kSpring;
    if (k < 100) continue;
    least = std::min(least, controller.gain());
    most = std::max(most, controller.gain());
  }
  EXPECT_LT(most - least, 1e-9);
  EXPECT_NEAR(most * (bare().debt + kDebt - (1.0 - most) * kSpring), bare().debt, 1e-9);
}

TEST(PassivityController, ADebtFadesWhereNothingIsTouched) {
  PassivityController controller(bare(), kTick);
  controller.observe(Vec6::Zero(), {0.0, 0.0}, 0.0);
  controller.sent(straight(1.0, 0, 0));
  controller.observe(straight(0.01, 0, 0), {0.0, 1.0}, 0.0);
  for (int k = 0; k < 1000; ++k) controller.forgive();
  EXPECT_NEAR(controller.energy(), -0.01 * std::exp(-1.0), 1e-9);
}

/// A device that the loop pushes, by 1 N, over a way on which the cloth gives nothing.
class Owing {
 public:
  explicit Owing(double way) {
    tick();
    push(way);
  }
  void push(double way) {
    place_ += way;
    tick();
  }
  /// Sways without a force, ten times a second.
  void sway(double time, double amplitude) {
    for (int k = 0; k < std::lround(time / kTick); ++k) {
      controller_.sent(Vec6::Zero());
      const double x = amplitude * std::sin(2.0 * EIGEN_PI * 10.0 * k * kTick);
      controller_.observe(straight(place_ + x, 0, 0), {0.0, 0.0}, 0.0);
    }
    controller_.sent(straight(1.0, 0, 0));
  }
  void rest(double time) { sway(time, 2e-5); }
  /// Goes where the force pushes it.
  void yield(double time, double speed) {
    for (int k = 0; k < std::lround(time / kTick); ++k) push(speed * kTick);
  }
  void leave(double time) {
    for (int k = 0; k < std::lround(time / kTick); ++k) controller_.forgive();
  }
  double debt() const { return -controller_.energy(); }
  double gain() const { return controller_.gain(); }

 private:
  void tick() {
    controller_.observe(straight(place_, 0, 0), {0.0, 0.0}, 0.0);
    controller_.sent(straight(1.0, 0, 0));
  }

  PassivityController controller_ = PassivityController(bare(), kTick);
  double place_ = 0.0;
};

TEST(PassivityController, ADebtFadesWhereTheDeviceRests) {
  // After 1.25 s the debt falls to 1/e in two seconds.
  Owing device(5e-3);
  device.rest(1.2);
  EXPECT_NEAR(device.debt(), 5e-3, 1e-9) << "not before";
  EXPECT_NEAR(device.gain(), 0.5e-3 / 5.5e-3, 1e-6);
  device.rest(4.05);
  EXPECT_NEAR(device.debt(), 5e-3 * std::exp(-2.0), 1e-5);
  device.rest(8.0);
  EXPECT_GT(device.gain(), 0.98);
}

TEST(PassivityController, AHandMayYieldToTheForceThatReturns) {
  // 1 N pushes it at 1.5 mm/s for 4 s. These 6 mJ are no new debt.
  Owing device(5e-3);
  device.rest(1.3);
  device.yield(4.0, 1.5e-3);
  EXPECT_NEAR(device.debt(), 5e-3 * std::exp(-2.0), 1e-4);
}

TEST(PassivityController, AMovingDeviceKeepsItsDebt) {
  Owing device(5e-3);
  device.sway(30.0, 1.5e-4);  // a swing of 0.15 mm is what test/stability calls a buzz
  EXPECT_NEAR(device.debt(), 5e-3, 1e-9);
}

TEST(PassivityController, ADebtThatGrowsAgainWaitsLonger) {
  // The loop makes 1 mJ whenever the force is back. The device rests for w, and if the debt has grown since
  // it last faded for 4 w more; then w becomes 4 w.
  Owing device(1e-3);
  for (const double wait : {0.25 + 1.0, 1.0 + 4.0, 4.0 + 16.0}) {
    device.rest(wait - 0.01);
    EXPECT_NEAR(device.debt(), 1e-3, 5e-5) << wait << " s";
    device.rest(8.0);  // to 0.05 mJ in 2 ln 20 = 6 s, then to 1/e in a second
    EXPECT_LT(device.debt(), 1e-5) << wait << " s";
    device.push(1e-3);
  }
  device.leave(10.0);
  device.push(1e-3);
  device.rest(1.24);
  EXPECT_NEAR(device.debt(), 1e-3, 5e-5) << "after leaving the cloth as at the start";
  device.rest(8.0);
  EXPECT_LT(device.debt(), 1e-5);
}

}  // namespace
}  // namespace haptic_cloth::probe_model_test
