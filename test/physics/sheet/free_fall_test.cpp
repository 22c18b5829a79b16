/// Free fall without air.
/// Criterion: v_n = g h n, and x_n by the formula of the integrator (Hairer, Nørsett, Wanner: Solving
/// ODEs I): the closed form g h² n (n+1)/2 of backward Euler, the recurrence of BDF2. A flat sheet falls as a
/// rigid body on any mesh, so this also holds while the mesh changes: merging cells must keep mass and
/// momentum.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/record.h"
#include "support/reference_solutions.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::free_fall_test {
namespace {

/// Fall after n steps [m].
double fallBy(Integrator integrator, double gravity, double time_step, int steps) {
  return integrator == Integrator::Euler ? backwardEulerFall(gravity, time_step, steps)
                                         : bdf2Fall(gravity, time_step, steps);
}

class FreeFall : public testing::TestWithParam<Strategy> {};

void expectFall(Strategy strategy, Integrator integrator) {
  Scene scene = sheetScene(makeFabric({}), 17, 17, 0.064, 0.064);
  setStrategy(scene, strategy, 2);
  scene.solver.integrator = integrator;
  scene.solver.minimizer.tolerance = 1e-8;
  scene.solver.minimizer.max_iterations = 2000;
  Simulation simulation(scene);
  const double g = 9.81, h = scene.solver.time_step;
  const int steps = 100;
  EXPECT_NEAR(simulation.mass(), 0.15 * 0.064 * 0.064, tolerance(1e-15));

  std::vector<Vec3> start, end;
  simulation.positions(start);
  for (int n = 0; n < steps; ++n) {
    const StepReport report = simulation.step();
    ASSERT_FALSE(report.failed) << "step " << n;
  }
  simulation.positions(end);

  // Each step leaves a residual acceleration of at most 1e-8 g, of either sign: relative error
  // 1e-8.
  const double fall = fallBy(integrator, g, h, steps);
  double worst = 0.0;
  for (std::size_t p = 0; p < start.size(); ++p) {
    worst = std::max(worst, (end[p] - start[p] + fall * Vec3::UnitZ()).norm());
  }
  record({"free fall for 0.1 s", "largest error of a position over the fall [-]", name(strategy),
          integrator == Integrator::Euler ? 1.0 : 2.0, worst / fall, 0.0, 1.0});
  EXPECT_LE(worst, tolerance(1e-7 * fall));
  EXPECT_NEAR(simulation.maxSpeed(), g * h * steps, tolerance(1e-7 * g * h * steps));
  EXPECT_NEAR(simulation.time(), h * steps, tolerance(1e-12));
  EXPECT_NEAR(simulation.mass(), 0.15 * 0.064 * 0.064, tolerance(1e-15));
}

TEST_P(FreeFall, FollowsBackwardEuler) { expectFall(GetParam(), Integrator::Euler); }
TEST_P(FreeFall, FollowsBdf2) { expectFall(GetParam(), Integrator::Bdf2); }

TEST_P(FreeFall, AirLimitsSpeed) {
  // The terminal velocity g / air_damping is reached within exp(-5) after 5 / air_damping.
  Scene scene = sheetScene(makeFabric({}), 9, 9, 0.032, 0.032);
  setStrategy(scene, GetParam(), 2);
  scene.air_damping = 20.0;
  scene.solver.minimizer.tolerance = 1e-6;
  Simulation simulation(scene);
  while (simulation.time() < 0.5) simulation.step();
  record({"fall through air", "terminal speed [m/s]", name(GetParam()), 0.0, simulation.maxSpeed(),
          9.81 / 20.0, 9.81 / 20.0});
  EXPECT_NEAR(simulation.maxSpeed(), 9.81 / 20.0, tolerance(1e-3));
}

INSTANTIATE_TEST_SUITE_P(Strategies, FreeFall,
                         testing::Values(Strategy::Finest, Strategy::Coarsest, Strategy::Refine,
                                         Strategy::Coarsen, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

TEST(FreeFall, IsExactWithStepsOfVaryingLength) {
  // v = g t after each step, and x by the formula of the step (src/sim/time_integrator.h).
  const std::vector<int> lengths{1, 2, 4, 8, 3, 1, 1, 5, 7, 1};
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    Scene scene = sheetScene(makeFabric({}), 17, 17, 0.064, 0.064);
    setStrategy(scene, Strategy::Amrc, 2);
    scene.solver.integrator = integrator;
    Simulation simulation(scene);
    const double g = -9.81, h = scene.solver.time_step;
    double z = 0.0, moved = 0.0;
    int last = 0, ticks = 0;
    for (int n = 0; n < 50; ++n) {
      const int length = lengths[n % lengths.size()];
      simulation.step(length);
      const bool second = integrator == Integrator::Bdf2 && last > 0;
      const double r = second ? static_cast<double>(length) / last : 0.0;
      ticks += length;
      moved = r * r / (1.0 + 2.0 * r) * moved + (1.0 + r) / (1.0 + 2.0 * r) * length * h * g * ticks * h;
      z += moved;
      last = length;
      EXPECT_DOUBLE_EQ(simulation.time(), ticks * h);
      // Rounding of positions near 1 m, divided by a step.
      EXPECT_NEAR(simulation.maxSpeed(), -g * ticks * h, tolerance(1e-9)) << n;
      EXPECT_NEAR(particle(simulation, 0, 0).z(), z, tolerance(1e-9)) << n;
    }
  }
}

TEST(FreeFall, NeedsNoTighterSolverThanTheDefaultAtAnyTimeStep) {
  // The initial guess of each solve includes the fall, so the fall is exact at any tolerance.
  for (const double time_step : {0.001, 0.01, 0.05}) {
    // Its preconditioner is far from uniform: without the guess it cannot fall in one iteration.
    LinearFabric stiff;
    stiff.rigidity = 1e-4;
    Scene scene = sheetScene(makeFabric(stiff), 33, 33, 0.1, 0.1);
    setStrategy(scene, Strategy::Finest, 0);
    scene.solver.time_step = time_step;
    Simulation simulation(scene);
    const int steps = static_cast<int>(std::lround(0.5 / time_step));
    for (int k = 0; k < steps; ++k) simulation.step();
    const double fall = fallBy(scene.solver.integrator, -9.81, time_step, steps);
    EXPECT_NEAR(particle(simulation, 16, 16).z(), fall, tolerance(1e-9)) << time_step;
    EXPECT_NEAR(particle(simulation, 0, 0).z(), fall, tolerance(1e-9)) << time_step;
  }
}

}  // namespace
}  // namespace haptic_cloth::free_fall_test
