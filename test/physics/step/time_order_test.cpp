/// Order of the time integrators.
/// Criteria: the error of a method of order p falls by 2^p with half the time step (Hairer, Nørsett,
/// Wanner: Solving ODEs I, II.3); cloth that lands does not fly up again; the floor takes its momentum
/// (Newton), and friction the share μ of that (Coulomb).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::time_order_test {
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

/// Sheet that falls flat on a plane.
Scene landing(Integrator integrator, double height) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 9, 9, 0.1, 0.1);
  scene.cloth.pose.position.z() = height;
  Obstacle plane;
  plane.shape = Shape::Plane;
  scene.obstacles.push_back(plane);
  scene.solver.integrator = integrator;
  return scene;
}

/// Share of the kinetic energy of a landing sheet, 3 steps after it is largest.
double keptByLanding(Integrator integrator) {
  Simulation simulation(landing(integrator, 0.05));
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

struct Landing {
  const char* name;
  Integrator integrator;
  double time_step;
};

class Lands : public testing::TestWithParam<Landing> {
 protected:
  static constexpr double kHeight = 0.03, kTime = 0.2, kTolerance = 1e-3;

  Lands() : scene(landing(GetParam().integrator, kHeight)) {
    scene.solver.time_step = GetParam().time_step;
    scene.solver.minimizer.tolerance = kTolerance;
    scene.solver.minimizer.max_iterations = 5000;
    scene.solver.sleep_speed = 0.0;
  }

  Scene scene;
};

TEST_P(Lands, AndTheFloorTakesItsMomentum) {
  Simulation simulation(scene);
  double momentum = 0.0;
  while (simulation.time() < kTime) {
    ASSERT_EQ(simulation.step().minimizer.why, Termination::Converged);
    momentum -= scene.solver.time_step * simulation.supportForce().z();
  }
  // Cloth that rests at both ends has given away what gravity gave it. Each step may leave kTolerance of the
  // weight. Cloth that falls by BDF2 has g h/2 more on its way than it fell for, since its first step is one
  // of backward Euler; the energy guard takes most of that.
  const double given = simulation.mass() * scene.gravity.z() * simulation.time();
  const bool second = GetParam().integrator == Integrator::Bdf2;
  const double on_its_way = second ? 0.5 * scene.solver.time_step / simulation.time() : 0.0;
  EXPECT_GT(momentum / given, 1.0 - tolerance(kTolerance));
  EXPECT_LT(momentum / given, 1.0 + tolerance(kTolerance + on_its_way));
}

TEST_P(Lands, AndABeltCarriesItAlong) {
  constexpr double kFriction = 0.4, kBelt = 2.0;  // the sheet does not come near the speed of the belt
  scene.obstacles[0].friction = kFriction;
  Simulation simulation(scene);
  while (simulation.time() < kTime) {
    simulation.moveObstacle(
        0, {Vec3(kBelt * (simulation.time() + scene.solver.time_step), 0.0, 0.0), Quat::Identity()});
    ASSERT_EQ(simulation.step().minimizer.why, Termination::Converged);
  }
  // Sliding friction is μ times the pressure, also in the impact: v = μ (√(2 g height) + g t) at t after it.
  const double g = scene.gravity.norm(), height = kHeight - scene.cloth.fabric.thickness,
               fall = std::sqrt(2.0 * height / g), slides = simulation.time() - fall;
  const double way = kFriction * (g * fall * slides + 0.5 * g * slides * slides);
  // The touch counts up to one step too late.
  const double speed = kFriction * g * simulation.time();
  EXPECT_NEAR(particle(simulation, 4, 4).x(), way, tolerance(1.0) * speed * scene.solver.time_step);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Lands,
                         testing::Values(Landing{"euler2ms", Integrator::Euler, 2e-3},
                                         Landing{"bdf2At1ms", Integrator::Bdf2, 1e-3},
                                         Landing{"bdf2At2ms", Integrator::Bdf2, 2e-3},
                                         Landing{"bdf2At4ms", Integrator::Bdf2, 4e-3}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace haptic_cloth::time_order_test
