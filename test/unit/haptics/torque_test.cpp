/// Torque on the hand: it follows the force, or the turn of the device, limited and ramped in the same way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/proxy.h"
#include "haptic_cloth/haptics.h"

namespace haptic_cloth::torque_test {
namespace {

constexpr double kTick = 1e-3;
/// Rounding error: torques are at most 0.1 N·m and forces 10 N, products of a few doubles.
constexpr double kRoundOff = 1e-12;
const Vec3 kArm(0.02, -0.01, 0.0);  ///< from the proxy to the point of contact [m]
/// From the device to the proxy: 2 N with the default coupling [m].
const Vec3 kSpring(0.0, 0.0, 0.005);

DeviceSample deviceAt(const Vec3& position, double received) {
  DeviceSample sample;
  sample.received = received;
  sample.position = position;
  return sample;
}

/// Result of a solve in which the coupling balances a point load.
ProbeSnapshot loadedAt(const Vec3& arm, double taken) {
  ProbeSnapshot snapshot;
  snapshot.taken = snapshot.device_received = taken;
  snapshot.proxy = kSpring;
  snapshot.force = HapticOptions().coupling_stiffness * kSpring;
  snapshot.torque = arm.cross(snapshot.force);
  snapshot.contact = true;
  return snapshot;
}

/// Options without soft start or effective limits.
HapticOptions bareOptions() {
  HapticOptions options;
  options.soft_start = 0.0;
  options.max_force = 3.3;
  options.max_force_rate = 1e9;
  options.max_torque = 1.0;
  return options;
}

/// Loop that has reached its full wrench.
struct LoadedLoop {
  HapticOptions options;
  HapticLoop loop{options};
  double now = 1.0;
  Vec3 force = Vec3::Zero();

  LoadedLoop() {
    for (int i = 0; i < 1000; ++i) tick(false);
  }
  void tick(bool paused) { tick(deviceAt(Vec3::Zero(), now + kTick), loadedAt(kArm, now + kTick), paused); }
  void tick(const DeviceSample& device, const ProbeSnapshot& snapshot, bool paused) {
    const Vec3 before = loop.torque();
    now += kTick;
    force = loop.tick(device, snapshot, paused, now);
    ASSERT_TRUE(loop.torque().allFinite());
    EXPECT_LE((loop.torque() - before).norm(), mostChange() + kRoundOff);
    EXPECT_LE(loop.torque().norm(), std::max(options.max_torque, before.norm()) + kRoundOff);
  }
  /// Largest change per tick: the torque takes as long as the force from zero to its limit.
  double mostChange() const {
    return options.max_force_rate / options.max_force * options.max_torque * kTick;
  }
};

TEST(HapticTorque, IsThatOfTheSolveWhereNothingHasMovedSince) {
  HapticLoop loop(bareOptions());
  const ProbeSnapshot snapshot = loadedAt(kArm, 1.0);
  const Vec3 force = loop.tick(deviceAt(Vec3::Zero(), 1.0), snapshot, false, 1.0);
  EXPECT_LT((force - snapshot.force).norm(), kRoundOff);
  EXPECT_LT((loop.torque() - snapshot.torque).norm(), kRoundOff);
}

/// The arm follows from force and torque of the solve, except for its part along the force. Its
/// error is the square of kTellingForce · max_force over the force: (0.165 N / 2 N)² = 0.7 % of the
/// change.
TEST(HapticTorque, KeepsItsArmWhereTheForceHasChangedSince) {
  const Vec3 moves[] = {Vec3(0.0, 0.0, -0.001), Vec3(0.0, 0.0, 0.002), Vec3(0.001, 0.0, 0.0)};
  for (const Vec3& moved : moves) {
    HapticLoop loop(bareOptions());
    const ProbeSnapshot snapshot = loadedAt(kArm, 1.0);
    const Vec3 force = loop.tick(deviceAt(moved, 1.001), snapshot, false, 1.001);
    const Vec3 change = kArm.cross(force - snapshot.force);
    ASSERT_GT(change.norm(), 1e-3);
    EXPECT_LT((loop.torque() - snapshot.torque - change).norm(), 0.007 * change.norm()) << moved.transpose();
  }
}

TEST(HapticTorque, OfAForceThroughTheOriginIsZeroWhereverItPoints) {
  HapticLoop loop(bareOptions());
  for (int i = 1; i <= 100; ++i) {
    const double now = 1.0 + i * kTick;
    const Vec3 moved(0.002 * std::sin(0.3 * i), 0.003 * std::cos(0.2 * i), -0.001 * std::sin(0.1 * i));
    EXPECT_GT(loop.tick(deviceAt(moved, now), loadedAt(Vec3::Zero(), now - 5 * kTick), false, now).norm(),
              0.5);
    EXPECT_EQ(loop.torque(), Vec3::Zero());
  }
}

/// The two sides of a fold may turn a probe without pushing it. The arm of a later force is then
/// unknown.
TEST(HapticTorque, ACoupleWithoutAForceIsKeptAndNeverMoreThanDoubled) {
  ProbeSnapshot snapshot = loadedAt(Vec3::Zero(), 1.0);
  snapshot.torque = Vec3(0.0, 0.03, 0.04);
  snapshot.proxy = snapshot.force = Vec3::Zero();
  HapticLoop still(bareOptions());
  still.tick(deviceAt(Vec3::Zero(), 1.0), snapshot, false, 1.0);
  EXPECT_LT((still.torque() - snapshot.torque).norm(), kRoundOff);
  for (const double force : {0.0, 1e-9, 1e-3, 0.1}) {
    snapshot.force = Vec3(force, 0.0, 0.0);
    for (const double way : {-0.004, 1e-4, 0.004}) {
      HapticLoop loop(bareOptions());
      loop.tick(deviceAt(Vec3(way, way, -way), 1.001), snapshot, false, 1.001);
      EXPECT_LE(loop.torque().norm(), 2.0 * snapshot.torque.norm() + kRoundOff) << force << " N, " << way;
      // Below 5 % of the largest force F the arm is F T/(5 % of it)², almost zero here.
      const double small = 0.05 * bareOptions().max_force, change = 400.0 * std::sqrt(3.0) * std::abs(way);
      const double most = (force + change) * force * snapshot.torque.norm() / (small * small);
      EXPECT_LE((loop.torque() - snapshot.torque).norm(), most + kRoundOff) << force << " N, " << way;
    }
  }
}

/// A probe whose coupling turns it: k r² times the turn that the cloth does not follow, as far as 0.5 rad,
/// and c r² times the same share of the angular velocity.
TEST(HapticTorque, AnswersATurnSinceTheSolve) {
  constexpr double kRadius = 0.04;
  const HapticOptions options = bareOptions();
  const double square = kRadius * kRadius, stiffness = options.coupling_stiffness * square;
  for (const double follow : {0.0, 0.75, 1.0}) {
    for (const double angle : {-0.2, 0.1, 0.9}) {
      ProbeSnapshot snapshot = loadedAt(Vec3::Zero(), 1.0);
      snapshot.turn_radius = kRadius;
      snapshot.follow.bottomRightCorner<3, 3>() = follow * Mat3::Identity();
      const Quat at = rotationBy(Vec3(0.3, -0.5, 0.2));
      snapshot.device_orientation = snapshot.proxy_orientation = at;
      DeviceSample device = deviceAt(Vec3::Zero(), 1.001);
      device.orientation = rotationBy(angle * Vec3::UnitY()) * at;
      device.angular_velocity = Vec3(0.0, 0.0, 2.0);
      HapticLoop loop(options);
      const Vec3 force = loop.tick(device, snapshot, false, 1.001);
      const double left = (1.0 - follow) * angle, spring = std::clamp(left, -0.5, 0.5);
      const double damper = options.coupling_damping * square * (1.0 - follow) * 2.0;
      EXPECT_LT((loop.torque() + Vec3(0.0, stiffness * spring, damper)).norm(), kRoundOff)
          << follow << ", " << angle << " rad";
      EXPECT_LT((force - snapshot.force).norm(), kRoundOff);
    }
  }
}

/// Turns and their torque have no part in the controller of the force: a wall that buzzes at a delay of 5 ms
/// is weakened as much, to the bit, for a hand that turns the probe as for one that does not.
TEST(HapticTorque, LeavesTheForceAlone) {
  HapticOptions options = bareOptions();
  options.passivity.loop_delay = 0.005;
  HapticLoop still(options), turning(options);
  double weakest = 1.0;
  for (int k = 1; k <= 2000; ++k) {
    const double now = 1.0 + k * kTick, height = -0.002 + 0.002 * std::sin(0.2 * k);
    ProbeSnapshot snapshot = loadedAt(Vec3::Zero(), now);
    snapshot.proxy.setZero();
    DeviceSample device = deviceAt(Vec3(0.0, 0.0, height), now);
    const Vec3 force = still.tick(device, snapshot, false, now);
    snapshot.turn_radius = 0.03;
    device.orientation = rotationBy(0.5 * std::sin(0.02 * k) * Vec3::UnitX());
    ASSERT_EQ(turning.tick(device, snapshot, false, now), force) << k;
    if (height < -0.003) weakest = std::min(weakest, force.norm() / (400.0 * -height));
  }
  EXPECT_LT(weakest, 0.9);
}

/// A debt of the force weakens the torque as well, so cloth that a hand turns against friction then takes
/// more by the solver's account than the hand gives. That must not become a debt of the torque: when the
/// force is paid for and the cloth turns the hand on, the hand meets all of its 0.03 N·m.
TEST(HapticTorque, WhatIsWeakenedWithTheForceIsNoDebt) {
  constexpr double kRadius = 0.03, kFriction = 0.03, kDeep = 0.004, kSpeed = 5.0;  // m, N·m, m, rad/s
  HapticOptions options = bareOptions();
  options.coupling_damping = 0.0;
  options.passivity.device_damping = options.passivity.loop_delay = 0.0;
  options.max_force = 8.0;
  options.max_torque = 1.0;
  const double lag = kFriction / (options.coupling_stiffness * kRadius * kRadius);
  HapticLoop loop(options);
  double angle = 0.0, felt = 0.0, most_owed = 0.0;
  constexpr int kDrives = 7000, kEnd = 9000;
  for (int k = 0; k < kEnd; ++k) {
    const double now = 1.0 + k * kTick, phase = 8.0 * EIGEN_PI * k * kTick;
    const bool owes = k < 1000, pays = k >= 5000 && k < kDrives, turns = !owes && !pays;
    const double side = k < kDrives ? -1.0 : 1.0;  // the proxy lags behind, then it leads
    if (turns) angle += kSpeed * kTick;
    DeviceSample device = deviceAt(Vec3(0.0, 0.0, -kDeep), now);
    if (!turns) device.position.z() += 0.5 * kDeep * std::sin(phase);
    device.orientation = rotationBy(angle * Vec3::UnitX());
    ProbeSnapshot snapshot = loadedAt(Vec3::Zero(), now);
    snapshot.force.setZero();
    snapshot.device = device.position;
    snapshot.device_orientation = device.orientation;
    snapshot.turn_radius = kRadius;
    snapshot.follow.setIdentity();
    snapshot.follow(2, 2) = 0.0;
    // A force that is a quarter of a period early makes energy, which the solver does not know of; a late one
    // takes it back.
    snapshot.proxy.z() = owes ? 0.003 * std::cos(phase) : pays ? -0.003 * std::cos(phase) : 0.003;
    if (turns) {
      snapshot.force.z() = options.coupling_stiffness * (0.003 + kDeep);
      snapshot.torque.x() = side * kFriction;
      snapshot.proxy_orientation = rotationBy((angle + side * lag) * Vec3::UnitX());
    } else {
      snapshot.proxy_orientation = device.orientation;
    }
    loop.tick(device, snapshot, false, now);
    if (owes) most_owed = std::max(most_owed, -loop.energy());
    if (k >= kDrives + 100) felt += loop.torque().x() / (kEnd - kDrives - 100);
  }
  EXPECT_GT(most_owed, options.passivity.debt);
  EXPECT_NEAR(felt, kFriction, 0.03 * kFriction);
}

/// A limit reduces the torque by the same share as the force, so the arm stays.
TEST(HapticTorque, IsCutWithTheForce) {
  HapticOptions options = bareOptions();
  options.max_force = 0.5;
  HapticLoop loop(options);
  const Vec3 force = loop.tick(deviceAt(Vec3::Zero(), 1.0), loadedAt(kArm, 1.0), false, 1.0);
  EXPECT_NEAR(force.norm(), 0.5, kRoundOff);
  EXPECT_LT((loop.torque() - kArm.cross(force)).norm(), kRoundOff);
}

TEST(HapticTorque, NeverExceedsItsLimit) {
  HapticOptions options = bareOptions();
  options.max_torque = 0.01;
  HapticLoop loop(options);
  const ProbeSnapshot snapshot = loadedAt(kArm, 1.0);
  loop.tick(deviceAt(Vec3::Zero(), 1.0), snapshot, false, 1.0);
  EXPECT_NEAR(loop.torque().norm(), 0.01, kRoundOff);
  EXPECT_NEAR(loop.torque().normalized().dot(snapshot.torque.normalized()), 1.0, kRoundOff);
  options.max_torque = 0.0;
  HapticLoop none(options);
  EXPECT_GT(none.tick(deviceAt(Vec3::Zero(), 1.0), snapshot, false, 1.0).norm(), 1.0);
  EXPECT_EQ(none.torque(), Vec3::Zero());
}

TEST(HapticTorque, ComesInSoftlyWithTheForce) {
  HapticOptions options;
  HapticLoop loop(options);
  for (int i = 1; i <= 600; ++i) {
    const double now = 1.0 + i * kTick;
    const Vec3 force = loop.tick(deviceAt(Vec3::Zero(), now), loadedAt(kArm, now), false, now);
    const double soft = std::min(1.0, i * kTick / options.soft_start);
    EXPECT_LE(loop.torque().norm(), soft * options.max_torque + kRoundOff) << "tick " << i;
    // Neither limit of the torque is reached here, so the torque always belongs to the force.
    EXPECT_LT((loop.torque() - kArm.cross(force)).norm(), 1e-9) << "tick " << i;
  }
  EXPECT_NEAR(loop.torque().norm(), kArm.norm() * 2.0, kRoundOff);
  options.max_torque = 0.01;  // reached long before the limit of the force
  HapticLoop limited(options);
  for (int i = 1; i <= 600; ++i) {
    const double now = 1.0 + i * kTick, soft = std::min(1.0, i * kTick / options.soft_start);
    limited.tick(deviceAt(Vec3::Zero(), now), loadedAt(kArm, now), false, now);
    EXPECT_LE(limited.torque().norm(), soft * options.max_torque + kRoundOff) << "tick " << i;
  }
  EXPECT_NEAR(limited.torque().norm(), options.max_torque, kRoundOff);
}

TEST(HapticTorque, NeverExceedsItsRate) {
  LoadedLoop loaded;
  for (int i = 0; i < 300; ++i) {
    // The load jumps from one end of the probe to the other every 40 ticks; contact comes and goes.
    ProbeSnapshot snapshot = loadedAt((i / 40) % 2 ? kArm : Vec3(-kArm), loaded.now + kTick);
    snapshot.contact = (i / 100) % 2 == 0;
    loaded.tick(deviceAt(Vec3::Zero(), loaded.now + kTick), snapshot, false);  // checks the rate
  }
  loaded.now += 0.5;  // the thread stalls: a late tick may catch up five ticks
  const Vec3 before = loaded.loop.torque();
  loaded.now += kTick;
  loaded.loop.tick(deviceAt(Vec3::Zero(), loaded.now), loadedAt(kArm, loaded.now), false, loaded.now);
  EXPECT_LE((loaded.loop.torque() - before).norm(), 5.0 * loaded.mostChange() + kRoundOff);
}

/// The arm of the load jumps by 45 mm in one solve. Snapshots come every 10 ms, so the change is
/// blended in over 5 ms.
TEST(HapticTorque, ANewSnapshotIsBlendedIn) {
  HapticLoop loop(bareOptions());
  const Vec3 far = -kArm, from = kArm.cross(Vec3(0, 0, 2.0)), to = far.cross(Vec3(0, 0, 2.0));
  double now = 1.0;
  for (int i = 0; i < 10; ++i, now += kTick)
    loop.tick(deviceAt(Vec3::Zero(), now), loadedAt(kArm, 1.0), false, now);
  EXPECT_LT((loop.torque() - from).norm(), kRoundOff);
  for (int i = 1; i <= 8; ++i, now += kTick) {
    ProbeSnapshot snapshot = loadedAt(far, 1.01);
    loop.tick(deviceAt(Vec3::Zero(), now), snapshot, false, now);
    const double share = std::min(1.0, i / 5.0);
    EXPECT_LT((loop.torque() - from - share * (to - from)).norm(), 1e-9) << "tick " << i;
  }
}

/// Both end after ramp_time, whatever their size.
TEST(HapticTorque, EndsInZeroWhereTheForceDoes) {
  enum Fault { Pause, Pose, Snapshot, Jump, TurnJump, OtherCloth, NotFinite };
  for (const Fault fault : {Pause, Pose, Snapshot, Jump, TurnJump, OtherCloth, NotFinite}) {
    SCOPED_TRACE(static_cast<int>(fault));
    LoadedLoop loaded;
    ASSERT_GT(loaded.loop.torque().norm(), 0.04);
    const double start = loaded.now, wait = fault == Pose       ? loaded.options.pose_timeout
                                            : fault == Snapshot ? loaded.options.snapshot_timeout
                                                                : 0.0;
    int cloth = 0;
    const int ticks = static_cast<int>(std::lround((wait + loaded.options.ramp_time) / kTick)) + 1;
    for (int i = 0; i < ticks; ++i) {
      const double next = loaded.now + kTick;
      DeviceSample device = deviceAt(Vec3::Zero(), fault == Pose ? start : next);
      ProbeSnapshot snapshot = loadedAt(kArm, fault == Snapshot ? start : next);
      if (fault == Jump) device.position.x() = 1.0;
      if (fault == TurnJump) {
        snapshot.turn_radius = 0.03;
        device.orientation = rotationBy(1.5 * Vec3::UnitX());  // a turn of a hand: 1 rad and 30 rad/s
      }
      if (fault == OtherCloth) snapshot.cloth = ++cloth;
      if (fault == NotFinite) snapshot.torque.y() = std::numeric_limits<double>::quiet_NaN();
      loaded.tick(device, snapshot, fault == Pause);
    }
    EXPECT_EQ(loaded.force, Vec3::Zero());
    EXPECT_EQ(loaded.loop.torque(), Vec3::Zero());
    // They return softly.
    loaded.tick(deviceAt(Vec3::Zero(), loaded.now + kTick), loadedAt(kArm, loaded.now + kTick), false);
    EXPECT_LE(loaded.loop.torque().norm(),
              loaded.options.max_torque * kTick / loaded.options.soft_start + kRoundOff);
  }
}

TEST(HapticTorque, IsFiniteWhateverTheSnapshotHolds) {
  const double huge[] = {1e-320, 1e200, 1e308, std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()};
  for (const double force : huge) {
    for (const double torque : huge) {
      HapticLoop loop(bareOptions());
      for (int i = 0; i < 10; ++i) {
        const double now = 1.0 + i * kTick;
        ProbeSnapshot snapshot = loadedAt(kArm, now);
        snapshot.force.y() = force;
        snapshot.torque.z() = torque;
        loop.tick(deviceAt(Vec3(0.0, 1e-3 * i, 0.0), now), snapshot, false, now);
        ASSERT_TRUE(loop.torque().allFinite()) << force << " N, " << torque << " N·m";
        ASSERT_LE(loop.torque().norm(), bareOptions().max_torque + kRoundOff);
      }
    }
  }
}

/// The limit is lowered to zero while the torque acts. The torque falls at the pace of the old
/// limit, to exactly zero.
TEST(HapticTorque, ALowerLimitIsReachedAtTheOldPace) {
  LoadedLoop loaded;
  HapticOptions lower = loaded.options;
  lower.max_torque = 0.0;
  loaded.loop.setOptions(lower);
  const double before = loaded.loop.torque().norm();
  const int ticks = static_cast<int>(std::ceil(before / loaded.mostChange()));
  for (int i = 0; i < ticks; ++i) {
    EXPECT_GT(loaded.loop.torque().norm(), 0.0) << "tick " << i;
    loaded.tick(false);  // checks the rate
  }
  EXPECT_EQ(loaded.loop.torque(), Vec3::Zero());
  EXPECT_NEAR(loaded.force.z(), 2.0, 1e-9);
}

/// The unit of the hand changes by three: values at the probe become a third, without a step at the
/// hand.
TEST(HapticTorque, GoesOnWhereTheForceScaleChanges) {
  LoadedLoop loaded;
  const Vec3 before = loaded.loop.torque();
  HapticOptions other = loaded.options;
  other.max_torque /= 3.0;
  other.max_force /= 3.0;
  other.max_force_rate /= 3.0;
  loaded.loop.setOptions(other, 3.0);
  EXPECT_LT((3.0 * loaded.loop.torque() - before).norm(), kRoundOff);
}

}  // namespace
}  // namespace haptic_cloth::torque_test
