/// Joint cost [M04] (positions, tensions, moments and shear forces as unknowns) against the
/// condensed one.
/// Criterion: both are zero at the same states, so without buckling both end in the same shape (rms
/// distance below 0.5 % of the cloth's size) with the same force on the probe (5 %), for a real
/// fabric with hysteresis.
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::joint_test {
namespace {

Fabric winterSuiting() { return loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"); }

/// Sheet held on all sides under a probe that comes down beside the middle.
Scene pressed(Strategy strategy) {
  Scene scene = sheetScene(winterSuiting(), 13, 13, 0.1, 0.1);
  pinAllSides(scene);
  scene.probes[0].radius = 0.01;
  quasiStatic(scene, 5.0, 1e-3, 0.02);
  setStrategy(scene, strategy, 2);
  return scene;
}

/// Sheet clamped at one side, which sinks under its own weight.
Scene sinking(Strategy strategy) {
  Scene scene = sheetScene(winterSuiting(), 17, 5, 0.08, 0.02);
  pin(scene, 0, 1, 0, 4);
  quasiStatic(scene, 10.0, 2e-3, 0.02);
  setStrategy(scene, strategy, 2);
  return scene;
}

struct End {
  std::vector<Vec3> positions;
  Vec3 force;
  long iterations = 0;
  int short_of_tolerance = 0;  ///< number of steps
};

constexpr int kSteps = 160, kPressing = 100;

End run(Scene scene, Cost cost, bool press) {
  scene.solver.cost = cost;
  scene.solver.minimizer.max_iterations = 1000;
  Simulation simulation(scene);
  End end;
  const double h = scene.solver.time_step;
  for (int step = 0; step < kSteps; ++step) {
    const double down = std::min(1.0, static_cast<double>(step) / kPressing);
    const double speed = step < kPressing ? 0.01 / (kPressing * h) : 0.0;
    if (press) simulation.setDevice(Vec3(0.005, 0.0, 0.0125 - 0.01 * down), Vec3(0.0, 0.0, -speed));
    const StepReport report = simulation.step();
    EXPECT_FALSE(report.failed) << step;
    end.short_of_tolerance += report.minimizer.why == Termination::Converged ? 0 : 1;
    end.iterations += report.minimizer.iterations;
  }
  simulation.positions(end.positions);
  end.force = simulation.probe().force;
  const CostReport left = simulation.cost();
  EXPECT_GT(left.motion, 0.0);
  EXPECT_EQ(left.bend > 0.0, cost == Cost::Joint);
  return end;
}

class Costs : public testing::TestWithParam<Strategy> {
 protected:
  void compare(const Scene& scene, const std::string& what, bool press) {
    const End condensed = run(scene, Cost::Condensed, press), joint = run(scene, Cost::Joint, press);
    double sum = 0.0, moved = 0.0;
    for (std::size_t p = 0; p < joint.positions.size(); ++p) {
      sum += (joint.positions[p] - condensed.positions[p]).squaredNorm();
      moved = std::max(moved, std::abs(condensed.positions[p].z()));
    }
    const double rms = std::sqrt(sum / joint.positions.size()), size = scene.cloth.size[kWarp];
    ASSERT_GT(moved, 0.05 * size) << "nothing happened";
    record({"joint cost, " + what, "rms distance from the condensed shape [m]", name(GetParam()), 0.0, rms,
            0.0, size});
    EXPECT_EQ(condensed.short_of_tolerance, 0);
    // The squared violation of an element has a kink where it turns from a branch of its loop onto
    // the path, and a step may end there: 19 of 160 do.
    EXPECT_LE(joint.short_of_tolerance, 0.2 * kSteps);
    std::cout << "  iterations: condensed " << condensed.iterations << ", joint " << joint.iterations << "\n";
    EXPECT_LT(rms, tolerance(0.005 * size));
    if (!press) return;
    ASSERT_GT(condensed.force.z(), 0.01);
    record({"joint cost, " + what, "probe force [N]", name(GetParam()), 0.0, joint.force.norm(),
            condensed.force.norm(), condensed.force.norm()});
    EXPECT_LT((joint.force - condensed.force).norm(), tolerance(0.05 * condensed.force.norm()));
  }
};

TEST_P(Costs, AgreeUnderTheProbe) { compare(pressed(GetParam()), "sheet under the probe", true); }
TEST_P(Costs, AgreeOnASinkingStrip) { compare(sinking(GetParam()), "sinking strip", false); }

/// Grasps a strip held at both ends beside its middle and lifts it by 10 mm. @return force on the
/// probe at the end [N]
Vec3 graspedAndLifted(Cost cost, Strategy strategy) {
  Scene scene = sheetScene(winterSuiting(), 13, 5, 0.06, 0.02);
  pin(scene, 0, 0, 0, 4);
  pin(scene, 12, 12, 0, 4);
  scene.probes[0].radius = 0.006;
  quasiStatic(scene, 10.0, 2e-3, 0.02);
  setStrategy(scene, strategy, 2);
  scene.solver.cost = cost;
  scene.solver.minimizer.max_iterations = 4000;
  Simulation simulation(scene);
  const double h = scene.solver.time_step, touching = scene.probes[0].radius;
  Vec3 device(0.005, 0.0, touching + 0.002);
  const auto move = [&](double speed, int steps) {
    for (int k = 0; k < steps; ++k) {
      device.z() += h * speed;
      simulation.setDevice(device, Vec3(0.0, 0.0, speed));
      EXPECT_FALSE(simulation.step().failed);
    }
  };
  move(0.0, 1);
  simulation.setGrasp(0, true);
  move(-0.1, 40);
  EXPECT_TRUE(simulation.probe().grasps);
  move(0.2, 25);
  move(0.0, 60);
  EXPECT_TRUE(simulation.probe().grasps);
  return simulation.probe().force;
}

TEST_P(Costs, AgreeOnWhatAGraspHolds) {
  const Vec3 condensed = graspedAndLifted(Cost::Condensed, GetParam()),
             joint = graspedAndLifted(Cost::Joint, GetParam());
  record({"joint cost, grasped strip", "probe force [N]", name(GetParam()), 0.0, joint.norm(),
          condensed.norm(), condensed.norm()});
  ASSERT_LT(condensed.z(), -1e-3) << "it pulls down";
  // 14 to 19 of the 126 steps of the joint cost end at its limit of iterations. What these leave across the
  // strip, where its symmetry has no force, hysteresis keeps: up to 12 % in 20 starts that are 0.1 µm apart.
  const Vec3 difference = joint - condensed, in_plane(difference.x(), 0.0, difference.z());
  EXPECT_LT(in_plane.norm(), tolerance(0.05 * condensed.norm()));
  EXPECT_LT(std::abs(difference.y()), tolerance(0.2 * condensed.norm())) << "1.7 times the largest seen";
  EXPECT_LT(std::abs(condensed.y()), tolerance(1e-3 * condensed.norm()));
}

INSTANTIATE_TEST_SUITE_P(Strategies, Costs, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

}  // namespace
}  // namespace haptic_cloth::joint_test
