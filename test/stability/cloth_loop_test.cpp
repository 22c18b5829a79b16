/// Closed loop with the real solver: a hand presses on a small cloth over a box.
/// Criteria as in devices_test.cpp. The force at rest is that of hand and coupling, two springs in
/// series. The compliance of cloth and contact can only reduce it; a fifth is allowed for them.
#include <gtest/gtest.h>

#include "stability/closed_loop.h"
#include "stability/cloth_probe.h"

namespace haptic_cloth::cloth_loop_test {
namespace {

LoopRun touchRun() {
  LoopRun run;
  run.options.coupling_stiffness = 400.0;
  run.options.coupling_damping = 1.0;
  run.options.soft_start = 0.1;
  run.device.mass = 0.05;
  run.device.damping = 0.2;
  run.device.quantum = 5.5e-5;
  run.device.noise = 0.5 * run.device.quantum;
  run.device.delay = 0.001;
  run.time = 1.5;
  return run;
}

LoopResult press(const LoopRun& run) {
  ClothWorldProbe world(smallDrape(run.options.coupling_stiffness, run.options.coupling_damping));
  const LoopResult result = runLoop(run, world);
  EXPECT_EQ(world.failed(), 0);
  EXPECT_TRUE(result.finite);
  EXPECT_LE(result.most_force, run.options.max_force * (1.0 + 1e-9));
  EXPECT_LE(result.most_change, run.options.max_force_rate / run.options.rate * (1.0 + 1e-9));
  return result;
}

/// Force of hand and coupling in series, 6 mm apart [N].
double springsInARow(const LoopRun& run) {
  const double a = run.hand.stiffness, b = run.options.coupling_stiffness;
  return a * b / (a + b) * -run.hand.pressed.z();
}

TEST(ClothLoop, IsQuietAndFirm) {
  const LoopRun run = touchRun();
  const LoopResult result = press(run);
  EXPECT_LT(result.amplitude, 1.5e-4);
  EXPECT_GT(result.mean_force, 0.8 * springsInARow(run));
  EXPECT_LT(result.mean_force, springsInARow(run) * 1.05);
}

TEST(ClothLoop, IsQuietWhileTheSolverIsSlow) {
  LoopRun run = touchRun();
  run.solver.slowness = 10.0;
  run.time = 2.5;
  EXPECT_LT(press(run).amplitude, 1.5e-4);
}

TEST(ClothLoop, IsQuietAfterAStall) {
  LoopRun run = touchRun();
  run.solver.stall_from = 0.5;
  run.solver.stall_time = 0.5;
  run.time = 2.0;
  const LoopResult result = press(run);
  EXPECT_LT(result.amplitude, 1.5e-4);
  EXPECT_GT(result.mean_force, 0.8 * springsInARow(run)) << "the force comes back";
}

TEST(ClothLoop, ADeadDeviceGetsZero) {
  LoopRun run = touchRun();
  run.device.dies_at = 0.8;
  run.time = 1.2;
  const LoopResult result = press(run);
  EXPECT_GT(result.most_force, 0.5);
  EXPECT_EQ(result.force_at_end, 0.0);
  EXPECT_LE(result.zero_since, run.device.dies_at + run.options.pose_timeout + 0.05);
}

}  // namespace
}  // namespace haptic_cloth::cloth_loop_test
