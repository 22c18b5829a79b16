/// Options that change between two ticks. Criterion: from one tick to the next the force on the
/// hand changes by at most max_force_rate times the tick (the loop's own bound, exact to
/// round-off), and it ends where a loop that started with the new options ends.
#include <gtest/gtest.h>

#include <cmath>

#include "haptic_cloth/haptics.h"
#include "haptics/gain_ramp.h"
#include "support/straight.h"

namespace haptic_cloth::live_gains_test {
namespace {

constexpr double kRoundOff = 1e-9;  ///< relative: sums of a few thousand terms

HapticOptions options() {
  HapticOptions options;
  options.soft_start = 0.0;
  options.max_force = 5.0;
  options.max_force_rate = 100.0;
  return options;
}

/// Hand that rests some way below a proxy that does not yield.
class Pressed {
 public:
  static constexpr double kDepth = 0.005;  ///< [m]

  HapticOptions limits;  ///< limits at the hand, from the next tick on

  explicit Pressed(const HapticOptions& options) : limits(options), loop_(options) {}

  /// Makes one tick with these gains. @return the force on the hand
  double tick(const Gains& gains) {
    HapticOptions now = limits;
    now.coupling_stiffness = gains.coupling_stiffness;
    now.coupling_damping = gains.coupling_damping;
    now.max_force /= gains.force_scale;
    now.max_force_rate /= gains.force_scale;
    loop_.setOptions(now, gains.force_scale / scale_);
    scale_ = gains.force_scale;
    time_ += 1.0 / limits.rate;
    DeviceSample device;
    device.received = time_;
    ProbeSnapshot snapshot;
    snapshot.taken = snapshot.device_received = time_;
    snapshot.proxy = Vec3(0.0, 0.0, kDepth);
    snapshot.contact = true;
    return scale_ * loop_.tick(device, snapshot, false, time_).z();
  }
  double time() const { return time_; }

 private:
  HapticLoop loop_;
  double time_ = 1.0, scale_ = 1.0;
};

/// Presses with `first` until rest, then changes to `second` within `ramp`. @return the last force
/// on the hand
double changed(const Gains& first, const Gains& second, double ramp) {
  Pressed hand(options());
  const double most = options().max_force_rate / options().rate * (1.0 + kRoundOff);
  double force = 0.0;
  for (int i = 0; i < 1000; ++i) force = hand.tick(first);
  EXPECT_NEAR(force, first.force_scale * first.coupling_stiffness * Pressed::kDepth, kRoundOff);
  const GainRamp gains = GainRamp(first).onTo(second, hand.time(), ramp);
  double largest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double next = hand.tick(gains.at(hand.time()));
    EXPECT_TRUE(std::isfinite(next));
    largest = std::max(largest, std::abs(next - force));
    force = next;
  }
  EXPECT_LE(largest, most);
  EXPECT_GT(largest, 0.0);
  return force;
}

TEST(GainRamp, IsAStraightLineThatTheNextOneGoesOnFrom) {
  const GainRamp ramp = GainRamp({100.0, 1.0, 1.0}).onTo({300.0, 2.0, 0.5}, 10.0, 2.0);
  EXPECT_EQ(ramp.at(9.0).coupling_stiffness, 100.0);
  EXPECT_EQ(ramp.at(10.5).coupling_stiffness, 150.0);
  EXPECT_EQ(ramp.at(11.0).coupling_damping, 1.5);
  EXPECT_EQ(ramp.at(11.0).force_scale, 0.75);
  EXPECT_FALSE(ramp.isDone(11.999));
  EXPECT_TRUE(ramp.isDone(12.0));
  EXPECT_EQ(ramp.at(99.0).coupling_stiffness, 300.0);
  const GainRamp back = ramp.onTo({100.0, 1.0, 1.0}, 11.0, 2.0);
  EXPECT_EQ(back.at(11.0).coupling_stiffness, 200.0);
  EXPECT_EQ(back.at(12.0).coupling_stiffness, 150.0);
  const GainRamp jump = ramp.onTo({50.0, 0.0, 2.0}, 11.0, 0.0);
  EXPECT_EQ(jump.at(11.0).coupling_stiffness, 50.0);
}

TEST(LiveGains, AStifferCouplingPressesHarderWithoutAStep) {
  for (const double ramp : {0.0, 0.5}) {
    SCOPED_TRACE(ramp);
    EXPECT_NEAR(changed({200.0, 1.0, 1.0}, {800.0, 1.0, 1.0}, ramp), 4.0, kRoundOff);
    EXPECT_NEAR(changed({800.0, 1.0, 1.0}, {200.0, 0.0, 1.0}, ramp), 1.0, kRoundOff);
    EXPECT_NEAR(changed({200.0, 1.0, 1.0}, {20000.0, 1.0, 1.0}, ramp), options().max_force, kRoundOff);
  }
}

TEST(LiveGains, AForceScaleIsReachedWithoutAStep) {
  for (const double ramp : {0.0, 0.5}) {
    SCOPED_TRACE(ramp);
    EXPECT_NEAR(changed({200.0, 1.0, 1.0}, {200.0, 1.0, 3.0}, ramp), 3.0, kRoundOff);
    EXPECT_NEAR(changed({200.0, 1.0, 3.0}, {200.0, 1.0, 0.25}, ramp), 0.25, kRoundOff);
    EXPECT_NEAR(changed({200.0, 1.0, 1.0}, {200.0, 1.0, 1000.0}, ramp), options().max_force, kRoundOff);
  }
}

TEST(LiveGains, TheRampIsSlowerThanTheLimit) {
  // From 200 to 600 N/m at 5 mm is 2 N; over 0.5 s that is a twenty-fifth of the 100 N/s allowed.
  Pressed hand(options());
  const Gains first{200.0, 1.0, 1.0};
  double force = 0.0;
  for (int i = 0; i < 1000; ++i) force = hand.tick(first);
  const GainRamp gains = GainRamp(first).onTo({600.0, 1.0, 1.0}, hand.time(), 0.5);
  for (int i = 0; i < 500; ++i) {
    const double next = hand.tick(gains.at(hand.time()));
    // The clock counts in binary fractions.
    EXPECT_LE(std::abs(next - force), 2.0 / 500 * (1.0 + 1e-6));
    force = next;
  }
}

TEST(LiveGains, ALowerLimitOfTheForceIsReachedWithoutAStep) {
  Pressed hand(options());
  const Gains gains{800.0, 1.0, 1.0};
  double force = 0.0;
  for (int i = 0; i < 1000; ++i) force = hand.tick(gains);
  ASSERT_NEAR(force, 4.0, kRoundOff);
  hand.limits.max_force = 0.5;
  for (int i = 0; i < 100; ++i) {
    const double next = hand.tick(gains);
    EXPECT_LE(std::abs(next - force), 0.1 * (1.0 + kRoundOff));
    force = next;
  }
  EXPECT_NEAR(force, 0.5, kRoundOff);
}

TEST(LiveGains, AnotherRateKeepsTheLimitOfTheForceInTime) {
  Pressed hand(options());
  const double depth_force = 200.0 * Pressed::kDepth;
  double force = 0.0;
  for (int i = 0; i < 5; ++i) force = hand.tick({200.0, 1.0, 1.0});
  EXPECT_NEAR(force, 0.5, kRoundOff);  // 5 ms at 100 N/s
  hand.limits.rate = 500.0;
  const double next = hand.tick({200.0, 1.0, 1.0});
  EXPECT_NEAR(next - force, 0.2, kRoundOff);  // 2 ms
  for (int i = 0; i < 100; ++i) force = hand.tick({200.0, 1.0, 1.0});
  EXPECT_NEAR(force, depth_force, kRoundOff);
}

TEST(LivePassivity, SpeedIsRightAtTheNewRateAndTheEnergyOfTheHandStays) {
  PassivityController passivity(PassivityOptions(), 1e-3);
  const double speed = 0.2;
  double x = 0.0;
  const auto tick = [&](double period, double force) {
    x += speed * period;
    passivity.observe(straight(x, 0.0, 0.0), {0.0, 0.05}, 0.0);
    passivity.sent(straight(force, 0.0, 0.0));
  };
  for (int i = 0; i < 20; ++i) tick(1e-3, -1.0);
  EXPECT_NEAR(passivity.velocity().x(), speed, 1e-12);
  const double energy = passivity.energy();
  // The hand now gets twice the force of the probe: half as much at the probe is the same to the
  // hand.
  passivity.setOptions(PassivityOptions(), 4e-3, 2.0);
  EXPECT_NEAR(2.0 * passivity.energy(), energy, 1e-15);
  for (int i = 0; i < 20; ++i) {
    tick(4e-3, -0.5);
    EXPECT_TRUE(passivity.velocity().isZero(0.0) || std::abs(passivity.velocity().x() - speed) < 1e-12);
  }
  EXPECT_NEAR(passivity.velocity().x(), speed, 1e-12);
}

}  // namespace
}  // namespace haptic_cloth::live_gains_test
