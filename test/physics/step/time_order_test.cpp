/// Order of the time integrators.
/// Criteria: the error of a method of order p falls by 2^p with half the time step (Hairer, Nørsett,
/// Wanner: Solving ODEs I, II.3); cloth that lands does not fly up again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

/// Positions of a sheet that is held at a corner, after a swing of 0.16 s from the horizontal.
std::vector<Vec3> swung(Integrator integrator, Strategy strategy, double time_step) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 9, 9, 0.2, 0.2);
  setStrategy(scene, strategy, 1);
  pin(scene, 0, 0, 0, 0);
  scene.air_damping = 2.0;
  scene.solver.integrator = integrator;
  scene.solver.time_step = time_step;
  scene.solver.minimizer.tolerance = 1e-5;
  scene.solver.minimizer.max_iterations = 5000;
  Simulation simulation(scene);
  const int steps = static_cast<int>(std::lround(0.16 / time_step));
  for (int n = 0; n < steps; ++n) EXPECT_EQ(simulation.step().minimizer.why, Termination::Converged);
  std::vector<Vec3> positions;
  simulation.positions(positions);
  return positions;
}

/// Root mean square of the distances [m].
double rms(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (std::size_t p = 0; p < a.size(); ++p) sum += (a[p] - b[p]).squaredNorm();
  return std::sqrt(sum / a.size());
}

TEST(TimeOrder, IsOneForBackwardEulerAndTwoForBdf2) {
  const std::vector<Vec3> exact = swung(Integrator::Bdf2, Strategy::Finest, 6.25e-5);
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    const bool second = integrator == Integrator::Bdf2;
    double before = 0.0;
    for (const double time_step : {1e-3, 5e-4, 2.5e-4}) {
      const double error = rms(swung(integrator, Strategy::Finest, time_step), exact);
      record({"swing of a sheet held at a corner", "error after 0.16 s [m]", second ? "bdf2" : "euler",
              time_step, error, 0.0, 0.2});
      if (before > 0.0) {
        // Three quarters of the order must be seen: steps are not yet small against all periods.
        EXPECT_GT(std::log2(before / error), tolerance(0.75) * (second ? 2.0 : 1.0)) << time_step;
      }
      before = error;
    }
  }
}

TEST(TimeOrder, AllowsLongerStepsWithBdf2) {
  // The second order saves three quarters of the steps.
  const std::vector<Vec3> exact = swung(Integrator::Bdf2, Strategy::Finest, 6.25e-5);
  const double euler = rms(swung(Integrator::Euler, Strategy::Finest, 5e-4), exact);
  EXPECT_LT(rms(swung(Integrator::Bdf2, Strategy::Finest, 2e-3), exact), tolerance(1.0) * euler);
}

/// Share of the kinetic energy of a sheet that falls flat on a plane, 3 steps after it is largest.
double keptByLanding(Integrator integrator) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 9, 9, 0.1, 0.1);
  scene.cloth.pose.position.z() = 0.05;
  Obstacle plane;
  plane.shape = Shape::Plane;
  scene.obstacles.push_back(plane);
  scene.solver.integrator = integrator;
  Simulation simulation(scene);
  std::vector<double> kinetic;
  while (simulation.time() < 0.15) {
    simulation.step();
    kinetic.push_back(simulation.energy().kinetic);
  }
  const auto most = std::max_element(kinetic.begin(), kinetic.end());
  return *(most + 3) / *most;
}

TEST(TimeOrder, LandingClothStays) {
  // A formula of second order that takes the impact for smooth motion gives back -u/2, a quarter of
  // the energy. A tenth of that is allowed to the elastic contact law.
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    EXPECT_LT(keptByLanding(integrator), tolerance(0.025));
  }
}

}  // namespace
}  // namespace haptic_cloth
