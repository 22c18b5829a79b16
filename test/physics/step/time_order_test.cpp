/// Order of the time integrators.
/// Criteria: the error of a method of order p falls by 2^p with half the time step (Hairer, Nørsett,
/// Wanner: Solving ODEs I, II.3); cloth that lands does not fly up again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

/// Positions of a sheet that is held at a corner, after a swing of 0.16 s from the horizontal.
/// @param lengths of the steps, repeated, in units of time_step
std::vector<Vec3> swung(Integrator integrator, Strategy strategy, double time_step,
                        const std::vector<int>& lengths = {1}) {
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
  for (std::size_t n = 0; simulation.time() < 0.16 - 0.5 * time_step; ++n) {
    EXPECT_EQ(simulation.step(lengths[n % lengths.size()]).minimizer.why, Termination::Converged);
  }
  EXPECT_NEAR(simulation.time(), 0.16, 1e-12);
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

TEST(TimeOrder, HoldsForStepsOfVaryingLength) {
  const std::vector<Vec3> exact = swung(Integrator::Bdf2, Strategy::Finest, 6.25e-5);
  const std::vector<std::vector<int>> patterns{{1, 2}, {1, 3}, {1, 1, 2, 4, 4, 2, 1, 1}};
  for (const std::vector<int>& lengths : patterns) {
    const int sum = std::accumulate(lengths.begin(), lengths.end(), 0),
              count = static_cast<int>(lengths.size());
    for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
      double before = 0.0;
      for (const int steps : {160, 320, 640}) {  // means of 1, 0.5 and 0.25 ms
        const int repeats = steps / count;
        const double error = rms(swung(integrator, Strategy::Finest, 0.16 / (sum * repeats), lengths), exact);
        // Three quarters of the order, as for equal steps.
        const double order = integrator == Integrator::Bdf2 ? 2.0 : 1.0;
        if (before > 0.0) {
          EXPECT_GT(std::log2(before / error), tolerance(0.75) * order) << sum << ", " << steps;
        }
        before = error;
      }
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
