/// Closed loop of hand, mechanism, delay, tick, solver and wall over stiffness, delay and damping.
/// Criterion 1: without the controller the loop is quiet at half of the bound K < (b + B)/(T/2 +
/// t_d) and not quiet at 2.5 times the bound [Gil, Sánchez, Hulin, Preusche & Hirzinger 2009,
/// "Stability boundary for haptic rendering: influence of damping and delay"; Colgate & Schenkel
/// 1994 for t_d = 0], so the simulated loop is that of the theory. The bound is linear and for a
/// free mechanism; the damping of the hand helps a little.
/// Criterion 2: with the controller nothing buzzes, at any stiffness and delay.
/// A buzz is a final swing of more than kBuzz: five quanta of the encoder. Below that the quantiser
/// has limit cycles of its own. It is also about what a hand perceives below 30 Hz, where these
/// loops swing (from memory of the literature on vibration thresholds).
/// Criterion 2 is reached with mechanisms of 1 N·s/m and more. With 0.2 N·s/m 17 of 200 points of
/// the full grid, most of them just above the bound, swing by up to 0.75 mm; they must stay below
/// kNearQuiet.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "stability/closed_loop.h"

namespace haptic_cloth::z_width_test {
namespace {

constexpr double kCouplingDamping = 1.0;  ///< B, default of a scene [N·s/m]
constexpr double kMass = 0.1;             ///< [kg]
constexpr double kBuzz = 1.5e-4;          ///< half of the peak-to-peak motion [m]
constexpr double kNearQuiet = 1e-3;       ///< with a mechanism of 0.2 N·s/m [m]

/// Stiffness K of the bound [N/m].
double bound(const HapticOptions& options, const DeviceModel& device) {
  return (device.damping + options.coupling_damping) / (0.5 / options.rate + device.delay);
}

LoopRun runOf(double stiffness, double delay, double damping, bool controlled) {
  LoopRun run;
  run.options.max_force = 8.0;
  run.options.max_force_rate = std::max(200.0, 0.5 * stiffness);  // 0.5 m/s into the wall
  run.options.soft_start = 0.1;
  run.options.coupling_stiffness = stiffness;
  run.options.coupling_damping = kCouplingDamping;
  run.options.passivity.loop_delay = delay;
  if (!controlled) run.options.passivity.damping = run.options.passivity.debt = 0.0;
  run.device.mass = kMass;
  run.device.damping = damping;
  run.device.delay = delay;
  run.hand.stiffness = 300.0;
  run.hand.damping = 0.5;
  run.time = 2.5;
  return run;
}

LoopResult touchWall(const LoopRun& run) {
  WallWorld wall(run.options, 1e9);
  return runLoop(run, wall);
}

TEST(ZWidth, TheLoopBuzzesWhereTheBoundSays) {
  for (const double delay : {0.001, 0.002, 0.005, 0.010}) {
    for (const double damping : {0.2, 1.0, 2.0}) {
      LoopRun run = runOf(1.0, delay, damping, false);
      const double limit = bound(run.options, run.device);
      run = runOf(0.5 * limit, delay, damping, false);
      EXPECT_LT(touchWall(run).amplitude, kBuzz) << "delay " << delay << " damping " << damping;
      run = runOf(2.5 * limit, delay, damping, false);
      const LoopResult buzz = touchWall(run);
      EXPECT_GT(buzz.amplitude, kBuzz) << "delay " << delay << " damping " << damping;
      EXPECT_GT(buzz.generated, 0.0) << "delay " << delay << " damping " << damping;
    }
  }
}

TEST(ZWidth, NothingBuzzesWithTheController) {
  for (const double stiffness : {200.0, 400.0, 800.0, 1600.0, 3200.0}) {
    for (const double delay : {0.0, 0.001, 0.002, 0.005, 0.010}) {
      for (const double damping : {0.2, 1.0, 4.0}) {
        const LoopResult result = touchWall(runOf(stiffness, delay, damping, true));
        EXPECT_LT(result.amplitude, kBuzz) << stiffness << " N/m, " << delay << " s, " << damping << " N·s/m";
        EXPECT_TRUE(result.finite);
      }
    }
  }
}

/// Writes the whole grid to a file for bench/z_width; these are the columns of its plot.
TEST(ZWidth, WritesTheGrid) {
  const char* file = std::getenv("HAPTIC_CLOTH_Z_WIDTH");
  std::ofstream stream(file != nullptr ? file : "/dev/null");
  const int columns = file != nullptr ? 25 : 5;
  stream << "controller,delay,damping,stiffness,bound,amplitude,generated,mean_force,stable\n";
  int rows = 0;
  for (const bool controlled : {false, true}) {
    for (const double damping : {0.2, 1.0, 4.0}) {
      for (const double delay : {0.0, 0.0005, 0.001, 0.002, 0.003, 0.005, 0.007, 0.010}) {
        for (int k = 0; k < columns; ++k) {
          const double stiffness = 50.0 * std::pow(100.0, static_cast<double>(k) / (columns - 1));
          const LoopRun run = runOf(stiffness, delay, damping, controlled);
          const LoopResult result = touchWall(run);
          ASSERT_TRUE(result.finite && std::isfinite(result.amplitude));
          if (controlled) {
            EXPECT_LT(result.amplitude, damping < 1.0 ? kNearQuiet : kBuzz)
                << stiffness << " N/m, " << delay << " s, " << damping << " N·s/m";
          }
          stream << controlled << ',' << delay << ',' << damping << ',' << stiffness << ','
                 << bound(run.options, run.device) << ',' << result.amplitude << ',' << result.generated
                 << ',' << result.mean_force << ',' << (result.amplitude < kBuzz) << '\n';
          ++rows;
        }
      }
    }
  }
  EXPECT_EQ(rows, 2 * 3 * 8 * columns);
  EXPECT_TRUE(stream.good());
}

}  // namespace
}  // namespace haptic_cloth::z_width_test
