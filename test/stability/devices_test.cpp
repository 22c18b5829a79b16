/// Devices within their published limits, on a rigid wall, with disturbances of the solver.
/// Criteria: no buzz, as in z_width_test.cpp, or at most two quanta of the encoder if that is more;
/// a finite force within force and rate limit at any time; a force of exactly zero from 50 ms after
/// the pose timeout of a dead device on. Limits of force, stiffness and damping: the makers' data
/// sheets and drivers (3D Systems Touch, Phantom Omni and Premium 1.5, Force Dimension omega,
/// Novint Falcon). Delay: up to 1 ms, or what the bound allows. Mechanism and hand: 0.05 to 0.2 kg,
/// 0.2 N·s/m, and a light grip of 100 to 1000 N/m and 2 N·s/m [Hajian & Howe 1997].
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "stability/closed_loop.h"

namespace haptic_cloth::devices_test {
namespace {

LoopRun runOf(const PublishedDevice& device, double stiffness, double damping, double delay) {
  LoopRun run;
  run.options.max_force = device.max_force;
  // 0.5 m/s into the stiffest wall.
  run.options.max_force_rate = std::max(200.0, 0.5 * device.stiffness);
  run.options.soft_start = 0.1;
  run.options.coupling_stiffness = stiffness;
  run.options.coupling_damping = damping;
  run.device.damping = 0.2;
  run.device.quantum = device.resolution;
  run.device.noise = 0.5 * device.resolution;
  // Delay of at most what the bound K < (b + B)/(T/2 + t_d) allows (z_width_test.cpp), possibly
  // zero.
  const double allowed = (run.device.damping + damping) / stiffness - 0.5 / run.options.rate;
  run.device.delay = std::clamp(allowed, 0.0, delay);
  run.time = 2.5;
  return run;
}

/// Speed at which a hand may yield to a force that returns: that of PassivityController.
constexpr double kDrift = 2e-3;

double buzz(const PublishedDevice& device) { return std::max(1.5e-4, 2.0 * device.resolution); }

class Devices : public testing::TestWithParam<PublishedDevice> {
 protected:
  void expectQuiet(const LoopRun& run, double wall_stiffness) {
    WallWorld wall(run.options, wall_stiffness);
    const LoopResult result = runLoop(run, wall);
    const auto what = [&] {
      return std::to_string(run.options.coupling_stiffness) + " N/m, " +
             std::to_string(run.options.coupling_damping) + " N·s/m, delay " +
             std::to_string(run.device.delay) + " s, " + std::to_string(run.device.mass) + " kg, hand " +
             std::to_string(run.hand.stiffness) + " N/m";
    };
    EXPECT_LT(result.amplitude, buzz(GetParam())) << what();
    EXPECT_LE(result.drift, kDrift) << what();
    EXPECT_TRUE(result.finite) << what();
    EXPECT_LE(result.most_force, run.options.max_force * (1.0 + 1e-9)) << what();
    EXPECT_LE(result.most_change, run.options.max_force_rate / run.options.rate * (1.0 + 1e-9)) << what();
  }

  /// Calls visit(run) for stiffness and damping within the limits, delays up to 1 ms if the bound
  /// allows them, hands and masses.
  template <class Visit>
  void forRuns(const Visit& visit) {
    const PublishedDevice& device = GetParam();
    for (const double stiffness : {0.25 * device.stiffness, 0.5 * device.stiffness, device.stiffness}) {
      for (const double damping : {0.0, 0.25 * device.damping, device.damping}) {
        for (const double delay : {0.0, 0.0005, 0.001}) {
          for (const double mass : {0.05, 0.1, 0.2}) {
            for (const double hand : {200.0, 300.0, 1000.0}) {
              LoopRun run = runOf(device, stiffness, damping, delay);
              run.device.mass = mass;
              run.hand.stiffness = hand;
              visit(run);
            }
          }
        }
      }
    }
  }
};

TEST_P(Devices, NothingBuzzesOnAWall) {
  forRuns([&](const LoopRun& run) { expectQuiet(run, 1e9); });
}

TEST_P(Devices, NothingBuzzesWhileTheSolverIsSlow) {
  forRuns([&](LoopRun run) {
    run.solver.slowness = 10.0;
    expectQuiet(run, 1e9);
  });
}

TEST_P(Devices, NothingBuzzesAfterAStall) {
  forRuns([&](LoopRun run) {
    run.solver.stall_from = 0.6;
    run.solver.stall_time = 0.5;
    expectQuiet(run, 1e9);
  });
}

TEST_P(Devices, NothingBuzzesOnASoftWall) {
  forRuns([&](LoopRun run) {
    run.solver.slowness = 5.0;
    expectQuiet(run, 200.0);
  });
}

TEST_P(Devices, ADeadDeviceGetsZero) {
  constexpr double kRamp = 0.05;
  LoopRun run = runOf(GetParam(), GetParam().stiffness, 1.0, 0.001);
  run.device.dies_at = 1.0;
  WallWorld wall(run.options, 1e9);
  const LoopResult result = runLoop(run, wall);
  EXPECT_GT(result.most_force, 0.5);
  EXPECT_TRUE(result.finite);
  EXPECT_EQ(result.force_at_end, 0.0);
  EXPECT_LE(result.zero_since, run.device.dies_at + run.options.pose_timeout + kRamp);
}

/// Poses that come 20 ms late for five seconds make the device swing, and the loop owes what that made. Then
/// they come at once, and the whole force returns: at rest that of hand and coupling, two springs in series.
TEST(LateDevice, ItsForceComesBack) {
  for (const double hand : {200.0, 300.0, 1000.0}) {
    LoopRun run;
    run.options.coupling_stiffness = 1000.0;
    run.options.max_force = 8.0;
    run.options.max_force_rate = 1000.0;
    run.hand.stiffness = hand;
    run.device.delay = 0.02;
    run.device.late_until = 5.0;
    const auto resultAt = [&](double time) {
      run.time = time;
      WallWorld wall(run.options, 1e9);
      return runLoop(run, wall);
    };
    const double whole = 1000.0 * hand / (1000.0 + hand) * -run.hand.pressed.z();
    EXPECT_LT(resultAt(6.0).mean_force, 0.7 * whole) << hand << " N/m: something must be owed";
    const LoopResult late = resultAt(25.0);
    EXPECT_GT(late.mean_force, 0.95 * whole) << hand << " N/m";
    EXPECT_LT(late.amplitude, 1.5e-4) << hand << " N/m";
  }
}

INSTANTIATE_TEST_SUITE_P(Published, Devices, testing::ValuesIn(publishedDevices()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace haptic_cloth::devices_test
