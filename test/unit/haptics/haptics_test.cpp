/// Haptic tick: forces that the hand may get, and forces that it must never get.
#include "haptic_cloth/haptics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "haptic_cloth/error.h"
#include "haptics/lateness.h"
#include "haptics/velocity_filter.h"

namespace haptic_cloth::haptics_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick = 1e-3;
/// Rounding error: forces here are at most 10 N, products of a few doubles.
constexpr double kRoundOff = 1e-12;

/// Options without soft start or effective rate limit, so that the coupling alone acts.
HapticOptions bareOptions() {
  HapticOptions options;
  options.soft_start = 0.0;
  options.max_force_rate = 1e9;
  options.max_force = 1e6;
  options.ramp_time = 0.02;
  return options;
}

DeviceSample deviceAt(const Vec3& position, double received) {
  DeviceSample sample;
  sample.received = received;
  sample.position = position;
  return sample;
}

ProbeSnapshot contactAt(const Vec3& proxy, double taken) {
  ProbeSnapshot snapshot;
  snapshot.taken = snapshot.device_received = taken;
  snapshot.proxy = proxy;
  snapshot.contact = true;
  return snapshot;
}

/// Loop that has reached its full force of about 2 N upwards at `now`.
struct PressedLoop {
  HapticOptions options;
  HapticLoop loop{options};
  double now = 1.0;
  Vec3 force = Vec3::Zero();

  PressedLoop() {
    for (int i = 0; i < 1000; ++i) tick(deviceAt(Vec3::Zero(), now), false);
  }
  Vec3 tick(const DeviceSample& device, bool paused) {
    now += kTick;
    return force = loop.tick(device, contactAt(Vec3(0.0, 0.0, 0.005), now), paused, now);
  }
};

TEST(HapticLoop, PushesTheHandTowardsTheProxy) {
  HapticLoop loop(bareOptions());
  // The device is 5 mm below the proxy that the cloth holds up, so the force on the probe is
  // upwards.
  const Vec3 force = loop.tick(deviceAt(Vec3(0, 0, -0.005), 1.0), contactAt(Vec3::Zero(), 1.0), false, 1.0);
  EXPECT_NEAR(force.z(), 400.0 * 0.005, kRoundOff);
  EXPECT_EQ(force.x(), 0.0);
  EXPECT_EQ(loop.status(), HapticStatus::Contact);
}

TEST(HapticLoop, PassesOnTheShareThatIsTrusted) {
  HapticLoop loop(bareOptions());
  ProbeSnapshot snapshot = contactAt(Vec3::Zero(), 1.0);
  snapshot.trust = 0.25;
  const Vec3 force = loop.tick(deviceAt(Vec3(0, 0, -0.005), 1.0), snapshot, false, 1.0);
  EXPECT_NEAR(force.z(), 0.25 * 400.0 * 0.005, kRoundOff);
  EXPECT_EQ(loop.forceShare(), 0.25);
}

TEST(HapticLoop, DampsTheVelocityDifference) {
  HapticLoop loop(bareOptions());
  DeviceSample device = deviceAt(Vec3::Zero(), 1.0);
  device.velocity = Vec3(0, 0, -0.3);
  ProbeSnapshot snapshot = contactAt(Vec3::Zero(), 1.0);
  snapshot.drift.z() = 0.1;
  EXPECT_NEAR(loop.tick(device, snapshot, false, 1.0).z(), 1.0 * (0.1 + 0.3), kRoundOff);
}

TEST(HapticLoop, CarriesTheProxyOnToNowButNotForEver) {
  HapticOptions options = bareOptions();
  options.coupling_damping = 0.0;
  ProbeSnapshot snapshot = contactAt(Vec3::Zero(), 1.0);
  snapshot.drift.x() = 0.1;
  // The drift fades in 10 ms: 0.1 m/s · 10 ms · (1 - exp(-age / 10 ms)).
  const auto reach = [](double age) { return 400 * 0.1 * 0.01 * (1.0 - std::exp(-age / 0.01)); };
  HapticLoop young(options), old(options);
  EXPECT_NEAR(young.tick(deviceAt(Vec3::Zero(), 1.01), snapshot, false, 1.01).x(), reach(0.01), 1e-9);
  EXPECT_NEAR(old.tick(deviceAt(Vec3::Zero(), 1.09), snapshot, false, 1.09).x(), reach(0.09), 1e-9);
}

TEST(HapticLoop, TheProxyFollowsTheDeviceAsTheClothLetsIt) {
  HapticOptions options = bareOptions();
  options.coupling_damping = 0.0;
  ProbeSnapshot snapshot = contactAt(Vec3(0, 0, 0.004), 1.0);
  snapshot.follow.diagonal().head<3>() = Vec3(1.0, 1.0, 0.25);
  HapticLoop loop(options);
  // Nothing resists 2 mm along x. Along z, 1 mm deeper stretches the coupling by three quarters of
  // that.
  const Vec3 force = loop.tick(deviceAt(Vec3(0.002, 0, -0.001), 1.001), snapshot, false, 1.001);
  EXPECT_NEAR(force.x(), 0.0, kRoundOff);
  EXPECT_NEAR(force.z(), 400.0 * (0.004 + 0.75 * 0.001), kRoundOff);
}

TEST(HapticLoop, ClothInTheHandAddsAtMostItsOwnForce) {
  // A hand moves on by 20 mm from a solve in which nothing followed: 8 N more by the coupling. Bounds of
  // coupling_model.h: the force of the solve, or 5 % of max_force.
  HapticOptions options = bareOptions();
  options.max_force = 10.0;
  const Vec3 moved(0.02, 0.0, 0.0);
  for (const double solved : {0.1, 2.0}) {
    ProbeSnapshot snapshot = contactAt(Vec3(-solved / 400.0, 0.0, 0.0), 1.0);
    HapticLoop touching(options), holding(options);
    EXPECT_NEAR(touching.tick(deviceAt(moved, 1.0), snapshot, false, 1.0).x(), -(solved + 8.0), kRoundOff);
    snapshot.holds = true;
    EXPECT_NEAR(holding.tick(deviceAt(moved, 1.0), snapshot, false, 1.0).x(),
                -(solved + std::max(solved, 0.05 * 10.0)), kRoundOff);
  }
}

TEST(HapticLoop, ANewSnapshotIsBlendedIn) {
  HapticLoop loop(bareOptions());
  // Snapshots are 10 ms apart, the second 1 mm higher: 0.4 N fade in during half of that time, five
  // ticks.
  double now = 1.0;
  Vec3 force = Vec3::Zero();
  for (int i = 0; i < 10; ++i, now += kTick)
    force = loop.tick(deviceAt(Vec3::Zero(), now), contactAt(Vec3(0, 0, 0.002), 1.0), false, now);
  EXPECT_NEAR(force.z(), 0.8, kRoundOff);
  for (int i = 1; i <= 8; ++i, now += kTick) {
    force = loop.tick(deviceAt(Vec3::Zero(), now), contactAt(Vec3(0, 0, 0.003), 1.01), false, now);
    EXPECT_NEAR(force.z(), 0.8 + 0.08 * std::min(5, i), 1e-9) << "tick " << i;
  }
}

TEST(HapticLoop, AnotherClothStartsSoftlyHoweverFastItCame) {
  PressedLoop pressed;
  ASSERT_NEAR(pressed.force.z(), 2.0, 1e-6);
  // No tick lacks a snapshot: the last one belongs to this cloth, the next to another.
  ProbeSnapshot other = contactAt(Vec3(0.0, 0.0, 0.005), pressed.now);
  other.cloth = 1;
  const HapticOptions& options = pressed.options;
  const auto tick = [&] {
    pressed.now += kTick;
    other.taken = pressed.now;
    return pressed.loop.tick(deviceAt(Vec3::Zero(), pressed.now), other, false, pressed.now).z();
  };
  double last = tick();
  EXPECT_EQ(pressed.loop.status(), HapticStatus::NoSnapshot);
  for (int i = 1; i <= 1000; ++i) {
    const double force = tick(), soft = std::min(1.0, i * kTick / options.soft_start) * options.max_force;
    EXPECT_LE(std::abs(force - last), options.max_force_rate * kTick + kRoundOff);
    // The ramp down from 2 N at 200 N/s takes 10 ticks.
    if (i > 10) {
      EXPECT_LE(force, soft + kRoundOff);
    }
    last = force;
  }
  EXPECT_NEAR(last, 2.0, 1e-6);
}

TEST(HapticLoop, AJumpOfTheDeviceIsNoPull) {
  // The device jumps by a metre in a tick: the spring would pull with 400 N, limited to 3.3 N. The
  // old force ramps to zero in ramp_time, and no force fades in once the solver has seen the new
  // position.
  PressedLoop pressed;
  ASSERT_NEAR(pressed.force.z(), 2.0, 1e-6);
  const Vec3 there(1.0, 0.0, 0.0);
  const ProbeSnapshot before = contactAt(Vec3(0.0, 0.0, 0.005), pressed.now);
  Vec3 force = pressed.force;
  for (int i = 0; i < 25; ++i) {
    pressed.now += kTick;
    const Vec3 last = force;
    force = pressed.loop.tick(deviceAt(there, pressed.now), before, false, pressed.now);
    EXPECT_EQ(pressed.loop.status(), HapticStatus::NoSnapshot);
    EXPECT_LE(force.norm(), last.norm()) << "tick " << i;
    EXPECT_EQ(force.x(), 0.0) << "tick " << i;
  }
  EXPECT_TRUE(force.isZero(0.0));
  ProbeSnapshot after = contactAt(there, pressed.now);
  after.device = there;
  for (int i = 0; i < 50; ++i) {
    pressed.now += kTick;
    after.taken = pressed.now;
    force = pressed.loop.tick(deviceAt(there, pressed.now), after, false, pressed.now);
    EXPECT_LE(force.norm(), kRoundOff) << "tick " << i;
  }
  EXPECT_EQ(pressed.loop.status(), HapticStatus::Contact);
}

TEST(HapticLoop, TheFastestHandIsNoJump) {
  // 10 m/s, with the oldest snapshot that is allowed.
  HapticLoop loop(bareOptions());
  const double age = 0.9 * bareOptions().snapshot_timeout;
  const Vec3 there(0.0, 0.0, -kFastestHand * age);
  EXPECT_GT(loop.tick(deviceAt(there, 1.0 + age), contactAt(Vec3::Zero(), 1.0), false, 1.0 + age).z(), 100.0);
  EXPECT_EQ(loop.status(), HapticStatus::Contact);
}

TEST(HapticLoop, FreeMotionFeelsNothing) {
  HapticLoop loop(bareOptions());
  ProbeSnapshot snapshot = contactAt(Vec3(0, 0, 0.05), 1.0);
  snapshot.drift << 1, 2, 3, 4, 5, 6;
  snapshot.force = Vec3(1, 1, 1);
  snapshot.contact = false;
  for (int i = 0; i < 50; ++i) {
    const double now = 1.0 + i * kTick;
    EXPECT_EQ(loop.tick(deviceAt(Vec3::Zero(), now), snapshot, false, now), Vec3::Zero());
  }
  EXPECT_EQ(loop.status(), HapticStatus::Free);
}

TEST(HapticLoop, NeverExceedsTheForceLimit) {
  HapticOptions options = bareOptions();
  options.max_force = 3.3;
  HapticLoop loop(options);
  ProbeSnapshot snapshot = contactAt(Vec3::Zero(), 1.0);
  snapshot.device = Vec3(-1.0, 2.0, -3.0);
  const Vec3 force = loop.tick(deviceAt(snapshot.device, 1.0), snapshot, false, 1.0);
  EXPECT_NEAR(force.norm(), 3.3, kRoundOff);
  EXPECT_NEAR(force.normalized().dot(Vec3(1.0, -2.0, 3.0).normalized()), 1.0, kRoundOff);
}

TEST(HapticLoop, NeverExceedsTheRateLimit) {
  HapticOptions options;
  options.soft_start = 0.0;
  HapticLoop loop(options);
  Vec3 last = Vec3::Zero();
  for (int i = 0; i < 200; ++i) {
    const double now = 1.0 + i * kTick;
    // The proxy jumps back and forth by 2 cm every 30 ticks, with and without contact.
    ProbeSnapshot snapshot = contactAt(Vec3((i / 30) % 2 ? 0.01 : -0.01, 0, 0), now);
    snapshot.contact = (i / 50) % 2 == 0;
    const Vec3 force = loop.tick(deviceAt(Vec3::Zero(), now), snapshot, false, now);
    EXPECT_LE((force - last).norm(), options.max_force_rate * kTick + kRoundOff) << "tick " << i;
    last = force;
  }
}

TEST(HapticLoop, AStallOfTheThreadIsNoJump) {
  PressedLoop pressed;
  const Vec3 before = pressed.force;
  pressed.now += 0.5;
  pressed.tick(deviceAt(Vec3(0, 0, 0.02), pressed.now), false);
  EXPECT_LE((pressed.force - before).norm(), 5 * kTick * pressed.options.max_force_rate + kRoundOff);
}

TEST(HapticLoop, StartsSoftly) {
  HapticOptions options = bareOptions();
  options.max_force = 2.0;
  options.soft_start = 0.5;
  HapticLoop loop(options);
  Vec3 force = Vec3::Zero();
  for (int i = 1; i <= 600; ++i) {
    const double now = 1.0 + i * kTick;
    ProbeSnapshot snapshot = contactAt(Vec3::Zero(), now);
    snapshot.device = Vec3(0, 0, -1.0);
    force = loop.tick(deviceAt(snapshot.device, now), snapshot, false, now);
    const double limit = options.max_force * std::min(1.0, i * kTick / options.soft_start);
    EXPECT_LE(force.norm(), limit + 1e-9) << "tick " << i;
  }
  EXPECT_NEAR(force.z(), 2.0, kRoundOff);
}

TEST(HapticLoop, AStalePoseRampsToExactlyZero) {
  PressedLoop pressed;
  ASSERT_NEAR(pressed.force.z(), 2.0, kRoundOff);
  const DeviceSample last = deviceAt(Vec3::Zero(), pressed.now);
  const double stale_at = pressed.now + pressed.options.pose_timeout;
  int ticks = 0;
  while (pressed.now < stale_at + pressed.options.ramp_time) {
    const Vec3 before = pressed.force;
    pressed.tick(last, false);
    EXPECT_LE((pressed.force - before).norm(), pressed.options.max_force_rate * kTick + kRoundOff);
    ++ticks;
  }
  EXPECT_EQ(pressed.force, Vec3::Zero());
  EXPECT_EQ(pressed.loop.status(), HapticStatus::PoseStale);
  EXPECT_GT(ticks, 50);
}

TEST(HapticLoop, AStaleSnapshotRampsToExactlyZero) {
  HapticOptions options;
  HapticLoop loop(options);
  Vec3 force = Vec3::Zero();
  double now = 1.0;
  for (int i = 0; i < 1000; ++i, now += kTick) {
    force = loop.tick(deviceAt(Vec3::Zero(), now), contactAt(Vec3(0, 0, 0.005), now), false, now);
  }
  ASSERT_GT(force.z(), 1.9);
  const ProbeSnapshot last = contactAt(Vec3(0, 0, 0.005), now);
  for (int i = 0; i < 125; ++i, now += kTick)
    force = loop.tick(deviceAt(Vec3::Zero(), now), last, false, now);
  EXPECT_EQ(force, Vec3::Zero());
  EXPECT_EQ(loop.status(), HapticStatus::SnapshotStale);
}

TEST(HapticLoop, PauseRampsToZeroAndStartsSoftlyAgain) {
  PressedLoop pressed;
  for (int i = 0; i < 20; ++i) pressed.tick(deviceAt(Vec3::Zero(), pressed.now), true);
  EXPECT_EQ(pressed.force, Vec3::Zero());
  EXPECT_EQ(pressed.loop.status(), HapticStatus::Paused);
  pressed.tick(deviceAt(Vec3::Zero(), pressed.now), false);
  EXPECT_LE(pressed.force.norm(), pressed.options.max_force * kTick / pressed.options.soft_start + kRoundOff);
}

TEST(HapticLoop, NothingThatIsNotFiniteGetsThrough) {
  for (int field = 0; field < 10; ++field) {
    PressedLoop pressed;
    for (int i = 0; i < 25; ++i) {
      pressed.now += kTick;
      DeviceSample device = deviceAt(Vec3::Zero(), pressed.now);
      ProbeSnapshot snapshot = contactAt(Vec3(0, 0, 0.005), pressed.now);
      double now = pressed.now;
      if (field == 0) device.position.x() = kNaN;
      if (field == 1) device.velocity.y() = std::numeric_limits<double>::infinity();
      if (field == 2) snapshot.proxy.z() = kNaN;
      if (field == 3) snapshot.drift.x() = kNaN;
      if (field == 4) device.received = kNaN;
      if (field == 5) now = kNaN;
      if (field == 6) device.orientation.w() = kNaN;
      if (field == 7) device.angular_velocity.y() = std::numeric_limits<double>::infinity();
      if (field == 8) snapshot.proxy_orientation.z() = kNaN;
      if (field == 9) snapshot.turn_radius = kNaN;
      const Vec3 before = pressed.force;
      pressed.force = pressed.loop.tick(device, snapshot, false, now);
      ASSERT_TRUE(pressed.force.allFinite()) << "field " << field;
      ASSERT_LE(pressed.force.norm(), before.norm()) << "field " << field;
    }
    EXPECT_EQ(pressed.force, Vec3::Zero()) << "field " << field;
    for (int i = 0; i < 1000; ++i) pressed.tick(deviceAt(Vec3::Zero(), pressed.now), false);
    EXPECT_NEAR(pressed.force.z(), 2.0, kRoundOff) << "no recovery from field " << field;
  }
}

TEST(HapticLoop, AnOverflowingCouplingIsNoForce) {
  HapticLoop loop(bareOptions());
  const Vec3 force =
      loop.tick(deviceAt(Vec3(1e308, 1e308, 0), 1.0), contactAt(Vec3(-1e308, 0, 0), 1.0), false, 1.0);
  EXPECT_EQ(force, Vec3::Zero());
}

TEST(HapticLoop, NoInputYet) {
  HapticLoop loop{HapticOptions()};
  EXPECT_EQ(loop.tick(DeviceSample(), ProbeSnapshot(), false, 5.0), Vec3::Zero());
  EXPECT_EQ(loop.status(), HapticStatus::NoPose);
  EXPECT_EQ(loop.tick(deviceAt(Vec3::Zero(), 5.0), ProbeSnapshot(), false, 5.0), Vec3::Zero());
  EXPECT_EQ(loop.status(), HapticStatus::NoSnapshot);
}

TEST(HapticOptions, ABadOneIsNamed) {
  HapticOptions options;
  options.max_force = kNaN;
  EXPECT_THROW(HapticLoop{options}, InputError);
  options = HapticOptions();
  options.ramp_time = 0.0;
  try {
    validateHapticOptions(options, "here");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("haptics/ramp_time"), std::string::npos) << error.what();
  }
}

/// The controller remembers no more ticks than the longest delay needs at the highest rate.
TEST(HapticOptions, ADelayThatIsNotRememberedIsRefused) {
  HapticOptions options;
  options.rate = kMostTickRate;
  options.passivity.loop_delay = kMostLoopDelay;
  EXPECT_NO_THROW(validateHapticOptions(options, "here"));
  options.passivity.loop_delay = 1.01 * kMostLoopDelay;
  try {
    validateHapticOptions(options, "here");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("haptics/passivity/loop_delay"), std::string::npos)
        << error.what();
  }
}

TEST(Mailbox, NewestWinsAndValuesAreWhole) {
  struct Value {
    long number = 0;
    std::array<long, 31> copies{};
  };
  Mailbox<Value> mailbox;
  constexpr long kLast = 300000;
  std::thread writer([&] {
    Value value;
    for (long i = 1; i <= kLast; ++i) {
      value.number = i;
      value.copies.fill(i);
      mailbox.write(value);
    }
  });
  long last = 0, torn = 0, backwards = 0;
  while (last < kLast) {
    const Value& value = mailbox.read();
    for (long copy : value.copies) torn += copy != value.number;
    backwards += value.number < last;
    last = value.number;
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
  EXPECT_EQ(mailbox.read().number, kLast);
}

TEST(VelocityFilter, FindsAConstantVelocityFromUnevenSamples) {
  VelocityFilter filter(0.01, 0.1);
  const Vec3 velocity(0.1, -0.2, 0.3);
  Vec3 found = Vec3::Zero();
  double time = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double passed = i % 3 ? 0.2e-3 : 2.6e-3;
    found = filter.update(velocity * passed, false, time += passed);
  }
  // 200 ms are 20 time constants, which leave e^-20 of the start.
  EXPECT_LT((found - velocity).norm(), 1e-8);
}

TEST(VelocityFilter, ABurstIsNoSpike) {
  VelocityFilter filter(0.01, 0.1);
  filter.update(Vec3::Zero(), false, 1.0);
  EXPECT_NEAR(filter.update(Vec3(1e-4, 0, 0), false, 1.0).x(), 0.01, 1e-9);
}

TEST(VelocityFilter, AGapStartsAgain) {
  VelocityFilter filter(0.01, 0.1);
  filter.update(Vec3::Zero(), false, 1.0);
  EXPECT_GT(filter.update(Vec3(0.01, 0, 0), false, 1.01).x(), 0.5);
  EXPECT_EQ(filter.update(Vec3(0.49, 0, 0), false, 2.0), Vec3::Zero());
}

TEST(VelocityFilter, AJumpStartsAgain) {
  VelocityFilter filter(0.01, 0.1);
  filter.update(Vec3::Zero(), false, 1.0);
  filter.update(Vec3(0.01, 0, 0), false, 1.01);
  EXPECT_EQ(filter.update(Vec3(0.99, 0, 0), true, 1.011), Vec3::Zero());
  EXPECT_GT(filter.update(Vec3(0.01, 0, 0), false, 1.012).x(), 0.5) << "from there on it is a motion";
}

TEST(LatenessHistogram, Quantiles) {
  LatenessHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0.0);
  for (int i = 1; i <= 100; ++i) histogram.add(i * 10e-6);
  EXPECT_NEAR(histogram.quantile(0.5), 500e-6, 6e-6);
  EXPECT_NEAR(histogram.quantile(0.99), 990e-6, 6e-6);
  EXPECT_EQ(histogram.max(), 1e-3);
  histogram.add(1.0);
  EXPECT_EQ(histogram.quantile(1.0), 1.0);
}

}  // namespace
}  // namespace haptic_cloth::haptics_test
