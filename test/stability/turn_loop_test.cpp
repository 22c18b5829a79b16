/// Closed loop of a hand that turns cloth in its grasp, mechanism, delay, tick and solver.
/// A turn times the radius of the coupling is a length, so the loop is that of z_width_test.cpp, and so are
/// its bound, K < (b + B)/(T/2 + t_d), and the criteria: without the controller the loop is quiet at half of
/// the bound and buzzes at 2.5 times the bound; with the controller nothing buzzes, but with a mechanism of
/// 0.2 N·s/m it may swing a little.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "contact/proxy.h"
#include "haptics/velocity_filter.h"
#include "stability/loop_parts.h"

namespace haptic_cloth::turn_loop_test {
namespace {

constexpr double kRadius = 0.03;          ///< at which the coupling of a sphere resists turns [m]
constexpr double kCouplingDamping = 1.0;  ///< B, default of a scene [N·s/m]
constexpr double kMass = 0.1;             ///< of mechanism and hand, at kRadius [kg]
constexpr double kQuantum = 5e-4;         ///< of the encoder [rad]
/// Half of the peak-to-peak motion of a buzz, and with a mechanism of 0.2 N·s/m: those of z_width_test.cpp at
/// kRadius [rad].
constexpr double kBuzz = 1.5e-4 / kRadius, kNearQuiet = 1e-3 / kRadius;
/// Length of a run, and of its end that counts [s]. Just above the bound a buzz grows for seconds before the
/// controller has found its energy.
constexpr double kTime = 10.0, kMeasured = 0.5;

/// Loop about the x axis. Stiffness, mass and damping are those at kRadius.
struct TurnRun {
  double stiffness;        ///< of the coupling [N/m]
  double delay;            ///< from torque to angle, half of it on either way [s]
  double damping;          ///< of the mechanism [N·s/m]
  bool controlled = true;  ///< by the passivity controller
  double follow = 0.0;     ///< dProxy/dDevice of the turn: 0: nothing yields [-]
  int slowness = 1;        ///< ticks per solve
};

struct TurnResult {
  double swing;        ///< half of the peak-to-peak angle [rad]
  double most_torque;  ///< [N·m]
  bool finite = true;
};

/// Probe that holds cloth, which turns with it by `follow`.
ProbeReport reportAt(double angle, double follow) {
  ProbeReport report;
  report.present = report.contact = report.grasps = true;
  report.turn_radius = kRadius;
  report.orientation = rotationBy(Vec3(follow * angle, 0.0, 0.0));
  return report;
}

TurnResult turn(const TurnRun& run) {
  HapticOptions options;
  options.max_torque = 0.3;
  options.max_force = 10.0;
  options.max_force_rate = std::max(200.0, 0.5 * run.stiffness);
  options.soft_start = 0.1;
  options.coupling_stiffness = run.stiffness;
  options.coupling_damping = kCouplingDamping;
  options.passivity.loop_delay = run.delay;
  if (!run.controlled) options.passivity.damping = options.passivity.debt = 0.0;
  HapticLoop loop(options);
  VelocityFilter filter(options.velocity_time_constant, options.pose_timeout);
  ProbeTracker tracker;
  DelayLine way_in(0.5 * run.delay), way_out(0.5 * run.delay);
  ProbeSnapshot snapshot;
  DeviceSample device;
  constexpr double kHandStiffness = 300.0, kHandDamping = 0.5;
  const double square = kRadius * kRadius, tick = 1.0 / options.rate;
  const int steps_per_tick = static_cast<int>(std::lround(tick / kStep));
  double angle = 0.0, rate = 0.0, low = 1e9, high = -1e9;
  Vec3 torque = Vec3::Zero();
  TurnResult result{};
  for (int k = 0; k * kStep < kTime; ++k) {
    const double time = k * kStep;
    const Vec3 seen = way_in.pass(Vec3(angle, 0.0, 0.0));
    if (k % steps_per_tick == 0) {
      const Quat before = device.orientation;
      device.received = time;
      device.orientation = rotationBy(Vec3(kQuantum * std::floor(seen.x() / kQuantum), 0.0, 0.0));
      device.angular_velocity = filter.update(turnBetween(before, device.orientation), false, time);
      if (k / steps_per_tick % run.slowness == 0) {
        const double solved = turnBetween(Quat::Identity(), device.orientation).x();
        snapshot = tracker.update(reportAt(solved, run.follow), device, run.slowness * tick, time);
      }
      loop.tick(device, snapshot, false, time);
      torque = loop.torque();
      result.finite = result.finite && torque.allFinite();
      result.most_torque = std::max(result.most_torque, torque.norm());
    }
    const double target = 0.15 * std::clamp(time / 0.5, 0.0, 1.0);  // [rad]
    const double hand = square * (kHandStiffness * (target - angle) - (kHandDamping + run.damping) * rate);
    rate += kStep / (square * kMass) * (way_out.pass(torque).x() + hand);
    angle += kStep * rate;
    if (time < kTime - kMeasured) continue;
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  result.swing = 0.5 * (high - low);
  EXPECT_TRUE(result.finite);
  EXPECT_LE(result.most_torque, options.max_torque * (1.0 + 1e-9));
  return result;
}

double bound(double delay, double damping) { return (damping + kCouplingDamping) / (0.5e-3 + delay); }

TEST(TurnLoop, BuzzesWhereTheBoundSays) {
  for (const double delay : {0.001, 0.002, 0.005}) {
    for (const double damping : {0.2, 1.0}) {
      SCOPED_TRACE("delay " + std::to_string(delay) + " s, damping " + std::to_string(damping) + " N·s/m");
      const double limit = bound(delay, damping);
      EXPECT_LT(turn({0.5 * limit, delay, damping, false}).swing, kBuzz);
      EXPECT_GT(turn({2.5 * limit, delay, damping, false}).swing, kBuzz);
    }
  }
}

TEST(TurnLoop, IsQuietWithTheController) {
  for (const double delay : {0.001, 0.002, 0.005}) {
    for (const double damping : {0.2, 1.0}) {
      for (const double share : {0.5, 1.2, 2.5, 5.0}) {
        for (const double follow : {0.0, 0.5}) {
          for (const int slowness : {1, 10}) {
            const double stiffness = share * bound(delay, damping);
            EXPECT_LT(turn({stiffness, delay, damping, true, follow, slowness}).swing,
                      damping < 1.0 ? kNearQuiet : kBuzz)
                << stiffness << " N/m, delay " << delay << " s, damping " << damping << " N·s/m, follow "
                << follow << ", a solve in " << slowness << " ticks";
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace haptic_cloth::turn_loop_test
