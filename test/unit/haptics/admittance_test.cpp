/// Virtual tool of admittance devices, and its tick.
/// Criteria: the closed solution of a damped mass under a constant force; the configured limits;
/// energy that only falls, for any stiffness and mass, as in an implicit step.
#include "haptic_cloth/admittance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "haptic_cloth/error.h"
#include "haptics/admittance_loop.h"

namespace haptic_cloth::admittance_test {
namespace {

constexpr double kTick = 1e-3;
constexpr double kRoundOff = 1e-12;

HapticOptions softlessOptions() {
  HapticOptions options;
  options.soft_start = 0.0;
  return options;
}

ForceSample pushed(const Vec3& force, double received) {
  ForceSample sample;
  sample.received = received;
  sample.force = force;
  return sample;
}

ProbeSnapshot nothingTouched(double taken) {
  ProbeSnapshot snapshot;
  snapshot.taken = snapshot.device_received = taken;
  snapshot.follow.setIdentity();
  return snapshot;
}

TEST(AdmittanceTool, MovesAsADampedMassDoes) {
  AdmittanceOptions options;
  AdmittanceTool tool(options);
  const Vec3 force(0.3, -0.4, 0.2);
  const double tau = options.mass / options.damping;
  for (int k = 1; k <= 500; ++k) {
    tool.move(force, Mat3::Zero(), Mat3::Zero(), kTick);
    const double t = k * kTick;
    const Vec3 way = force / options.damping * (t - tau * (1.0 - std::exp(-t / tau)));
    // Implicit Euler is ahead or behind by at most one tick's motion.
    EXPECT_LT((tool.position() - options.start - way).norm(), force.norm() / options.damping * kTick) << t;
  }
  EXPECT_NEAR((tool.velocity() - force / options.damping).norm(), 0.0, 0.01 * force.norm() / options.damping);
}

TEST(AdmittanceTool, ASpringOfAnyStiffnessTakesEnergy) {
  for (const double mass : {1e-3, 0.1, 2.0}) {
    for (const double stiffness : {1.0, 400.0, 1e5, 1e8}) {
      AdmittanceOptions options;
      options.mass = mass;
      options.damping = 1e-6;
      options.max_acceleration = options.max_speed = 1e9;
      AdmittanceTool tool(options);
      const Vec3 anchor = options.start + Vec3(0.0, 0.0, 0.01);
      const auto energy = [&] {
        return 0.5 * mass * tool.velocity().squaredNorm() +
               0.5 * stiffness * (tool.position() - anchor).squaredNorm();
      };
      double before = energy();
      const double start = before;
      for (int k = 0; k < 2000; ++k) {
        tool.move(stiffness * (anchor - tool.position()), stiffness * Mat3::Identity(), Mat3::Zero(), kTick);
        EXPECT_LE(energy(), before + kRoundOff * start) << mass << " kg, " << stiffness << " N/m";
        before = energy();
      }
    }
  }
}

TEST(AdmittanceTool, KeepsItsLimits) {
  AdmittanceOptions options;
  AdmittanceTool tool(options);
  const Vec3 force(40.0, 30.0, -50.0);
  Vec3 before = tool.velocity();
  double fastest = 0.0;
  for (int k = 0; k < 4000; ++k) {
    tool.move(k < 2000 ? force : Vec3(-force), Mat3::Zero(), Mat3::Zero(), kTick);
    fastest = std::max(fastest, tool.velocity().norm());
    EXPECT_LE(tool.velocity().norm(), options.max_speed * (1.0 + kRoundOff));
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(std::abs(tool.velocity()[c] - before[c]),
                options.max_acceleration * kTick * (1.0 + 1e-6) + kRoundOff);
      EXPECT_LE(tool.position()[c], options.workspace_high[c] + kRoundOff);
      EXPECT_GE(tool.position()[c], options.workspace_low[c] - kRoundOff);
    }
    before = tool.velocity();
    if (k == 1999) {
      EXPECT_NEAR(tool.position().x(), options.workspace_high.x(), 1e-4) << "it gets there";
    }
  }
  EXPECT_NEAR(fastest, options.max_speed, 1e-6);
}

TEST(AdmittanceTool, PlacedOutsideItOnlyComesIn) {
  AdmittanceOptions options;
  AdmittanceTool tool(options);
  const Vec3 outside = options.workspace_high + Vec3(0.1, -0.2, -0.2);
  tool.place(outside);
  for (int k = 0; k < 100; ++k) tool.move(Vec3(3.0, 0.0, 0.0), Mat3::Zero(), Mat3::Zero(), kTick);
  EXPECT_EQ(tool.position(), outside);
  for (int k = 0; k < 100; ++k) tool.move(Vec3(-3.0, 0.0, 0.0), Mat3::Zero(), Mat3::Zero(), kTick);
  EXPECT_LT(tool.position().x(), outside.x());
}

TEST(AdmittanceTool, BrakesToExactlyZero) {
  AdmittanceOptions options;
  AdmittanceTool tool(options);
  for (int k = 0; k < 200; ++k) tool.move(Vec3(2.0, 0.0, 0.0), Mat3::Zero(), Mat3::Zero(), kTick);
  const double speed = tool.velocity().norm();
  ASSERT_GT(speed, 0.2);
  const int ticks = static_cast<int>(std::ceil(speed / (options.max_acceleration * kTick)));
  for (int k = 0; k < ticks; ++k) tool.brake(kTick);
  EXPECT_TRUE(tool.velocity().isZero(0.0));
}

TEST(AdmittanceLoop, StandsUntilThereIsAForce) {
  AdmittanceLoop loop(softlessOptions());
  const Vec3 device(0.05, 0.0, 0.1);
  loop.place({device, Quat::Identity()}, 1.0);
  loop.tick(ForceSample(), nothingTouched(1.0), false, 1.0);
  EXPECT_FALSE(loop.started());
  EXPECT_EQ(loop.status(), HapticStatus::NoForce);
  EXPECT_LT(loop.device().received, 0.0) << "not in the scene";
  loop.tick(pushed(Vec3(1, 0, 0), 1.001), nothingTouched(1.001), false, 1.001);
  EXPECT_TRUE(loop.started());
  EXPECT_EQ(loop.device().position, device);
  loop.place({Vec3::Zero(), Quat::Identity()}, 1.002);
  loop.tick(pushed(Vec3(1, 0, 0), 1.002), nothingTouched(1.002), false, 1.002);
  EXPECT_NEAR((loop.device().position - device).norm(), 0.0, 1e-5) << "it has started";
}

/// Forces may come before poses. The device would be sent to `start` from wherever it is.
TEST(AdmittanceLoop, TheFirstPlaceCountsEvenAfterTheStart) {
  AdmittanceLoop loop(softlessOptions());
  for (double now : {1.0, 1.001}) loop.tick(pushed(Vec3(1, 0, 0), now), nothingTouched(now), false, now);
  ASSERT_TRUE(loop.started());
  const Vec3 device(0.05, 0.0, 0.1);
  loop.place({device, Quat::Identity()}, 1.001);
  EXPECT_EQ(loop.position(), device);
  EXPECT_TRUE(loop.atRest());
  loop.place({Vec3::Zero(), Quat::Identity()}, 1.002);
  EXPECT_EQ(loop.position(), device) << "the second one does not count";
}

TEST(AdmittanceLoop, IgnoresAPoseThatIsOlderThanTheLast) {
  AdmittanceLoop loop(softlessOptions());
  const Quat turned(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  loop.place({Vec3(0.05, 0.0, 0.1), turned}, 1.001);
  loop.place(Pose(), 1.0);
  EXPECT_EQ(loop.position(), Vec3(0.05, 0.0, 0.1));
  EXPECT_EQ(loop.device().orientation.coeffs(), turned.coeffs());
}

/// Loop whose tool moves at about 0.2 m/s.
struct MovingLoop {
  HapticOptions options = softlessOptions();
  AdmittanceLoop loop{options};
  double now = 1.0;

  MovingLoop() {
    for (int k = 0; k < 300; ++k) step(pushed(Vec3(1, 0, 0), now), now, false);
    EXPECT_GT(loop.device().velocity.norm(), 0.18);
  }
  void step(const ForceSample& force, double taken, bool paused) {
    now += kTick;
    loop.tick(force, nothingTouched(taken), paused, now);
  }
  /// Ticks until the tool must stand still: the time that braking takes.
  void expectRest(const std::function<void()>& tick, HapticStatus status) {
    const double time = options.admittance.max_speed / options.admittance.max_acceleration;
    for (double t = 0.0; t < time + 2.0 * kTick; t += kTick) tick();
    EXPECT_TRUE(loop.atRest());
    EXPECT_EQ(loop.status(), status);
    const Vec3 there = loop.device().position;
    for (int k = 0; k < 100; ++k) tick();
    EXPECT_EQ(loop.device().position, there);
    EXPECT_TRUE(loop.started());
  }
};

TEST(AdmittanceLoop, ComesToRestWhenTheForceIsLost) {
  MovingLoop moving;
  const ForceSample last = pushed(Vec3(1, 0, 0), moving.now);
  while (moving.now < last.received + moving.options.admittance.force_timeout - kTick) {
    moving.step(last, moving.now, false);
    EXPECT_FALSE(moving.loop.atRest());
  }
  moving.step(last, moving.now, false);
  moving.expectRest([&] { moving.step(last, moving.now, false); }, HapticStatus::ForceStale);
  EXPECT_LT(moving.loop.device().received, last.received + moving.options.admittance.force_timeout + kTick)
      << "a silent hand leaves the scene in the end";
}

TEST(AdmittanceLoop, ComesToRestInAPauseAndWithoutTheSolver) {
  MovingLoop paused;
  paused.expectRest([&] { paused.step(pushed(Vec3(1, 0, 0), paused.now), paused.now, true); },
                    HapticStatus::Paused);
  MovingLoop stalled;
  const double last = stalled.now;
  while (stalled.now <= last + stalled.options.snapshot_timeout)
    stalled.step(pushed(Vec3(1, 0, 0), stalled.now), last, false);
  stalled.expectRest([&] { stalled.step(pushed(Vec3(1, 0, 0), stalled.now), last, false); },
                     HapticStatus::SnapshotStale);
}

/// Where the tool is inside the cloth, it brakes as it does elsewhere, and moves along and out as if free.
TEST(AdmittanceLoop, InsideTheClothItMovesNoDeeper) {
  MovingLoop moving;
  const AdmittanceOptions& tool = moving.options.admittance;
  const Vec3 out(-0.6, 0.0, 0.8), along(0.8, 0.0, 0.6);
  const auto tick = [&](const Vec3& force) {
    ProbeSnapshot inside = nothingTouched(moving.now += kTick);
    inside.inside = true;
    inside.way_out = out;
    moving.loop.tick(pushed(force, moving.now), inside, false, moving.now);
  };
  const Vec3 start = moving.loop.position(), velocity = moving.loop.device().velocity;
  const double inward = -velocity.dot(out), way = inward * inward / (2.0 * tool.max_acceleration);
  ASSERT_GT(inward, 0.1);
  for (int k = 0; k < 500; ++k) tick(-2.0 * out);
  // A tick more for each of Euler's steps.
  EXPECT_NEAR((moving.loop.position() - start).dot(out), -way, 2.0 * kTick * inward);
  const Vec3 stopped = moving.loop.position();
  for (int k = 0; k < 1000; ++k) tick(0.5 * along - 2.0 * out);
  EXPECT_NEAR((moving.loop.position() - stopped).dot(out), 0.0, 1e-9);
  EXPECT_NEAR(moving.loop.device().velocity.dot(along), 0.5 / tool.damping, 1e-3 / tool.damping);
  for (int k = 0; k < 1000; ++k) tick(0.5 * out);
  EXPECT_NEAR(moving.loop.device().velocity.dot(out), 0.5 / tool.damping, 1e-3 / tool.damping);
}

TEST(AdmittanceLoop, AForceThatIsNotFiniteIsNone) {
  MovingLoop moving;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  moving.expectRest([&] { moving.step(pushed(Vec3(nan, 0, 0), moving.now), moving.now, false); },
                    HapticStatus::ForceStale);
  EXPECT_TRUE(moving.loop.device().position.allFinite());
}

TEST(AdmittanceLoop, ATimeThatIsNotFiniteIsThatOfOneFaultyTick) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    MovingLoop moving;
    const double good = moving.now;
    moving.loop.tick(pushed(Vec3(1, 0, 0), good), nothingTouched(good), false, bad);
    EXPECT_NE(moving.loop.status(), HapticStatus::Free) << bad;
    const double before = moving.loop.device().position.x();
    for (int k = 0; k < 10; ++k) moving.step(pushed(Vec3(1, 0, 0), moving.now), moving.now, false);
    EXPECT_EQ(moving.loop.status(), HapticStatus::Free) << bad;
    EXPECT_TRUE(moving.loop.position().allFinite()) << bad;
    EXPECT_GT(moving.loop.position().x(), before) << bad;
  }
}

TEST(AdmittanceLoop, TheForceComesInSoftlyAndNoStrongerThanItMay) {
  HapticOptions options;  // with a soft start of half a second
  AdmittanceLoop loop(options);
  double now = 1.0;
  loop.tick(pushed(Vec3(1e6, 0, 0), now), nothingTouched(now), false, now);
  // Bound m v < ∫ F dt: the force grows linearly up to its limit.
  double impulse = options.max_force / options.soft_start * kTick * kTick;
  for (int k = 0; k < 100; ++k) {
    now += kTick;
    loop.tick(pushed(Vec3(1e6, 0, 0), now), nothingTouched(now), false, now);
    EXPECT_LE(options.admittance.mass * loop.device().velocity.norm(), impulse + kRoundOff);
    impulse += options.max_force * std::min(1.0, (k + 2) * kTick / options.soft_start) * kTick;
  }
  EXPECT_GT(loop.device().velocity.norm(), 0.0);
}

TEST(AdmittanceLoop, TheDeadbandIsTakenOff) {
  HapticOptions options = softlessOptions();
  options.admittance.deadband = 0.1;
  AdmittanceLoop loop(options);
  double now = 1.0;
  const auto run = [&](double force, double time) {
    for (double t = 0.0; t < time; t += kTick, now += kTick)
      loop.tick(pushed(Vec3(0, force, 0), now), nothingTouched(now), false, now);
  };
  run(0.1, 0.1);
  EXPECT_TRUE(loop.atRest());
  run(0.6, 1.0);
  EXPECT_NEAR(loop.device().velocity.y(), 0.5 / options.admittance.damping, 1e-4);
}

TEST(AdmittanceLoop, BadOptionsAreNamed) {
  const auto message = [](const std::function<void(AdmittanceOptions&)>& change) -> std::string {
    HapticOptions options;
    change(options.admittance);
    try {
      AdmittanceLoop loop(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  const auto named = [&](const char* key, const std::function<void(AdmittanceOptions&)>& change) {
    EXPECT_NE(message(change).find(std::string("haptics/admittance/") + key), std::string::npos)
        << message(change);
  };
  named("mass", [](AdmittanceOptions& o) { o.mass = 0.0; });
  named("damping", [](AdmittanceOptions& o) { o.damping = -1.0; });
  named("deadband", [](AdmittanceOptions& o) { o.deadband = -0.1; });
  named("force_timeout", [](AdmittanceOptions& o) { o.force_timeout = 0.0; });
  named("max_speed", [](AdmittanceOptions& o) { o.max_speed = std::nan(""); });
  named("max_acceleration", [](AdmittanceOptions& o) { o.max_acceleration = 0.0; });
  named("workspace_high", [](AdmittanceOptions& o) { o.workspace_high.z() = o.workspace_low.z(); });
  named("start", [](AdmittanceOptions& o) { o.start.x() = 1.0; });
}

/// With another force scale the same hand comes as another force on the probe, and mass, damping and
/// limits of the tool come in that unit, too: the hand feels the same tool.
TEST(AdmittanceLoop, AnotherForceScaleLeavesTheToolOfTheHand) {
  const HapticOptions before = softlessOptions();
  HapticOptions after = before;
  const double unit = 0.25;  // new force scale / old one
  after.admittance.mass /= unit;
  after.admittance.damping /= unit;
  after.admittance.deadband /= unit;
  after.max_force /= unit;
  after.max_force_rate /= unit;
  AdmittanceLoop same(before), other(before);
  const Vec3 force(0.04, -0.03, 0.02);
  for (int k = 1; k <= 400; ++k) {
    const double now = k * kTick;
    const bool changed = k > 100;  // while it moves
    if (k == 101) other.setOptions(after, unit);
    same.tick(pushed(force, now), nothingTouched(now), false, now);
    other.tick(pushed(changed ? Vec3(force / unit) : force, now), nothingTouched(now), false, now);
    ASSERT_LT((other.position() - same.position()).norm(), kRoundOff) << k;
  }
  EXPECT_GT((same.position() - before.admittance.start).norm(), 1e-3);
}

}  // namespace
}  // namespace haptic_cloth::admittance_test
