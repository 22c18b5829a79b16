/// Quantities that must not change, or only in one direction.
/// Criteria: equal bits for any number of threads (decision 0008), with each instruction set of the
/// machine (ctest runs this file with all of them); reset() repeats the same run; without a device
/// energy is only lost (backward Euler is dissipative on a convex potential).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "haptic_cloth/machine.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::conservation_test {
namespace {

std::uint64_t hashAfter(Simulation& simulation, int steps) {
  for (int n = 0; n < steps; ++n) simulation.step();
  return simulation.stateHash();
}

void expectEqualBits(Integrator integrator) {
  Scene scene = boxDrape(33);
  scene.solver.integrator = integrator;
  std::uint64_t one = 0;
  for (const int threads : {1, 2, 3, 4}) {
    scene.solver.threads = threads;
    Simulation simulation(scene);
    EXPECT_EQ(simulation.threads(), threads);
    const std::uint64_t hash = hashAfter(simulation, 300);
    if (threads == 1) one = hash;
    EXPECT_EQ(hash, one) << threads << " threads, " << instructionSet();
  }
}

TEST(Determinism, AnyNumberOfThreadsGivesTheSameBits) { expectEqualBits(Integrator::Euler); }
TEST(Determinism, AnyNumberOfThreadsGivesTheSameBitsWithBdf2) { expectEqualBits(Integrator::Bdf2); }

/// Steps in which layers press on each other. The mesh stays fine enough for four threads.
TEST(Determinism, AnyNumberOfThreadsGivesTheSameBitsInAFold) {
  Scene scene = foldedSheet(65);
  scene.adapt.coarsen_below = 0.01;
  scene.adapt.refine_above = 0.02;
  Simulation folds(scene);
  hashAfter(folds, 85);
  const std::string folded = folds.saveState();
  std::uint64_t one = 0;
  for (const int threads : {1, 2, 3, 4}) {
    scene.solver.threads = threads;
    Simulation simulation(scene);
    simulation.loadState(folded, "state");
    const std::uint64_t hash = hashAfter(simulation, 10);
    const StepReport report = simulation.step();
    EXPECT_GT(report.self_contacts, 50);
    EXPECT_GT(report.active_particles, 900) << "too few for four threads (parallel_for.h)";
    if (threads == 1) one = hash;
    EXPECT_EQ(hash, one) << threads << " threads, " << instructionSet();
  }
}

TEST(Determinism, ResetRepeatsTheRun) {
  Simulation simulation(boxDrape(17));
  const std::uint64_t start = simulation.stateHash();
  const std::uint64_t first = hashAfter(simulation, 200);
  EXPECT_NE(start, first);
  simulation.reset();
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_EQ(simulation.stateHash(), start);
  EXPECT_EQ(hashAfter(simulation, 200), first);
}

/// Velocity of the centre of mass from the positions at both ends of a step [m/s].
Vec3 meanVelocity(const Scene& scene, const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                  int length = 1) {
  const auto [columns, rows] = scene.cloth.particles;
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for (int p = 0; p < columns * rows; ++p) {
    const int i = p % columns, j = p / columns;
    const double weight = (i == 0 || i == columns - 1 ? 0.5 : 1.0) * (j == 0 || j == rows - 1 ? 0.5 : 1.0);
    sum += weight * (after[p] - before[p]);
    weights += weight;
  }
  return sum / (weights * length * scene.solver.time_step);
}

class AfterABlow : public testing::TestWithParam<Integrator> {};

TEST_P(AfterABlow, FreeClothKeepsItsMomentum) {
  // A sphere hits weightless cloth off its centre and draws back. In a step each solve may leave a net force
  // of 0.01 of the tolerance times the weight, and the energy guard takes nothing from the motion as a whole.
  LinearFabric linear;
  linear.rigidity = 4e-6;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.14, 0.12);
  scene.gravity.setZero();
  scene.solver.minimizer = MinimizerOptions();
  scene.solver.time_step = 1e-3;
  scene.solver.integrator = GetParam();
  setStrategy(scene, Strategy::Amrc, 2);
  Obstacle sphere;
  sphere.shape = Shape::Sphere;
  sphere.radius = 0.012;
  sphere.friction = 0.3;
  sphere.pose.position = Vec3(0.035, 0.02, -0.02);
  scene.obstacles = {sphere};
  Simulation simulation(scene);
  std::vector<Vec3> before, after;
  const auto step = [&] {  // momentum over mass [m/s]
    simulation.positions(before);
    EXPECT_EQ(simulation.step().minimizer.why, Termination::Converged);
    simulation.positions(after);
    return meanVelocity(scene, before, after);
  };
  for (int k = 1; k <= 60; ++k) {
    const double height = k <= 50 ? -0.02 + 0.5e-3 * k : 0.005 - 0.02 * (k - 50);
    simulation.moveObstacle(0, {Vec3(0.035, 0.02, height), Quat::Identity()});
    step();
  }
  const Vec3 start = step();
  EXPECT_EQ(simulation.supportForce().norm(), 0.0);
  constexpr int kSteps = 800;
  Vec3 end;
  for (int k = 0; k < kSteps; ++k) end = step();
  record({"weightless cloth after a blow, 0.8 s", "change of momentum / momentum [-]", "amrc",
          GetParam() == Integrator::Bdf2 ? 2.0 : 1.0, (end - start).norm() / start.norm(), 0.0, 1.0});
  EXPECT_GT(start.norm(), 0.1);
  EXPECT_LT((end - start).norm(), tolerance(0.01 * 0.1 * 9.81 * scene.solver.time_step * kSteps));
}

/// A strip keeps what a probe gave it, with these lengths of steps in turn.
void pushAStrip(Integrator integrator, const std::vector<int>& lengths) {
  // A capsule pushes the middle of a weightless strip, whose halves fold onto each other behind it, and draws
  // back.
  Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/wool_tropical.yaml"), 29, 7,
                           0.084, 0.018);
  scene.gravity.setZero();
  scene.air_damping = 0.0;
  scene.solver.time_step = 1e-3;
  scene.solver.integrator = integrator;
  scene.solver.sleep_speed = 0.0;
  scene.solver.minimizer.tolerance = 1e-3;
  scene.solver.minimizer.max_iterations = 5000;
  ProbeOptions& probe = scene.probes[0];
  probe.radius = 0.004;
  probe.length = 0.025;
  probe.friction = 0.2;
  const Quat across(Eigen::AngleAxisd(M_PI_2, Vec3::UnitX()));  // the capsule lies along the weft
  constexpr double kSpeed = 0.8, kReach = 0.1, kTime = 0.25;
  Simulation simulation(scene);
  std::vector<Vec3> before, after;
  Vec3 given = Vec3::Zero(), velocity = Vec3::Zero();  // over the mass [m/s]
  double left = 0.0;                                   // by the residuals of all steps [m/s]
  int touching = 0;
  for (std::size_t k = 0; simulation.time() < kTime; ++k) {
    const int length = lengths[k % lengths.size()];
    const double time_step = length * scene.solver.time_step;
    const double way = std::min(kSpeed * simulation.time(), kReach);
    const bool present = simulation.time() * kSpeed < 1.2 * kReach;
    if (present) {
      simulation.setDevice(
          0, {Vec3(0.0, 0.0, way - 0.009), Vec3(0.0, 0.0, way < kReach ? kSpeed : 0.0), across});
    } else {
      simulation.removeDevice(0);
    }
    simulation.positions(before);
    const StepReport report = simulation.step(length);
    ASSERT_EQ(report.minimizer.why, Termination::Converged);
    simulation.positions(after);
    velocity = meanVelocity(scene, before, after, length);
    if (present) given -= time_step / simulation.mass() * simulation.probe(0).force;
    left += report.minimizer.residual * 9.80665 * time_step;
    touching += report.self_contacts > 0 ? 1 : 0;
  }
  record({"weightless strip pushed by a probe and folded", "change of momentum / momentum [-]", "finest",
          integrator == Integrator::Bdf2 ? 2.0 : 1.0, (velocity - given).norm() / given.norm(), 0.0, 1.0});
  EXPECT_GT(touching, 10);
  EXPECT_GT(given.norm(), 0.3);
  EXPECT_LT((velocity - given).norm(), tolerance(left));
}

TEST_P(AfterABlow, AStripKeepsWhatAProbeGaveIt) { pushAStrip(GetParam(), {1}); }

TEST_P(AfterABlow, AStripKeepsWhatAProbeGaveItInUnequalSteps) { pushAStrip(GetParam(), {1, 2, 4, 2, 1}); }

INSTANTIATE_TEST_SUITE_P(Integrators, AfterABlow, testing::Values(Integrator::Euler, Integrator::Bdf2),
                         [](const auto& info) { return info.param == Integrator::Bdf2 ? "bdf2" : "euler"; });

class Energy : public testing::TestWithParam<std::tuple<Strategy, Integrator>> {};

TEST_P(Energy, IsOnlyLost) {
  const auto [strategy, integrator] = GetParam();
  // A sheet held at two corners falls, swings and comes to rest.
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 17, 17, 0.2, 0.2);
  setStrategy(scene, strategy, 2);
  scene.solver.integrator = integrator;
  pin(scene, 0, 0, 0, 0);
  pin(scene, 16, 16, 0, 0);
  scene.air_damping = 0.5;
  scene.solver.minimizer.tolerance = 1e-2;
  scene.solver.minimizer.max_iterations = 1000;
  Simulation simulation(scene);
  const double start = simulation.energy().total() + simulation.energy().dissipated;
  const double scale = simulation.mass() * 9.81 * 0.2;  // energy of the largest possible fall [J]
  double before = simulation.energy().dissipated, worst_rise = 0.0, worst_drift = 0.0;
  while (simulation.time() < 1.0) {
    ASSERT_FALSE(simulation.step().failed);
    const EnergyReport energy = simulation.energy();
    worst_rise = std::max(worst_rise, before - energy.dissipated);
    worst_drift = std::max(worst_drift, std::abs(energy.total() + energy.dissipated - start));
    before = energy.dissipated;
  }
  // The balance sums rounded terms.
  EXPECT_LE(worst_drift, tolerance(1e-9 * scale));
  std::cout << "  " << name(strategy) << ": largest gain in a step " << worst_rise / scale << "\n";
  // Merging four cells into one of 25 mm moves the nodes between them onto straight lines, by up to
  // coarsen_below / 8 of 25 mm. If the whole sheet did so at once, upwards, that would be 4e-3 of
  // the fall; a few cells at a time give less. Splitting a bilinear cell leaves its curvature on
  // its sides, which doubles the bending energy of these cells for a moment. A fixed mesh gains
  // nothing.
  const bool changes = strategy != Strategy::Finest && strategy != Strategy::Coarsest;
  EXPECT_LE(worst_rise, tolerance((changes ? 1e-3 : 1e-5) * scale));
  EXPECT_GT(before, 0.05 * scale);
  EXPECT_LT(before, scale);
}

INSTANTIATE_TEST_SUITE_P(Strategies, Energy,
                         testing::Combine(testing::Values(Strategy::Finest, Strategy::Coarsest,
                                                          Strategy::Refine, Strategy::Coarsen,
                                                          Strategy::Amrc),
                                          testing::Values(Integrator::Euler, Integrator::Bdf2)),
                         [](const auto& info) {
                           const bool second = std::get<1>(info.param) == Integrator::Bdf2;
                           return name(std::get<0>(info.param)) + (second ? "_bdf2" : "");
                         });

}  // namespace
}  // namespace haptic_cloth::conservation_test
