/// Pins that move.
/// Criteria: pinned particles are where their motion says; cloth turned slowly keeps its shape and
/// stores nothing; the work of the pins is what the cloth stores, weighs and moves with, minus what
/// backward Euler loses.
#include <gtest/gtest.h>

#include <cmath>

#include "haptic_cloth/error.h"
#include "sim/cloth_world.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::moving_pins_test {
namespace {

LinearFabric stiffFabric() {
  LinearFabric linear;
  linear.stiffness = 1000.0;
  linear.rigidity = 1e-5;
  return linear;
}

Scene weightlessSheet(int columns, int rows, double length, double width) {
  Scene scene = sheetScene(makeFabric(stiffFabric()), columns, rows, length, width);
  scene.gravity = Vec3::Zero();
  scene.solver.minimizer.tolerance = 1e-5;
  scene.solver.minimizer.max_iterations = 2000;
  scene.solver.sleep_speed = 0.0;
  return scene;
}

void run(Simulation& simulation, double time) {
  while (simulation.time() < time - 1e-9) ASSERT_FALSE(simulation.step().failed);
}

/// A cell that turns by a in each step. Its velocities are the last step's way, so they lead to a position
/// turned by a/2 to third order in a.
TEST(MovingPins, NormalsAreThoseOfTheMiddleOfAStep) {
  constexpr double kRate = 20.0;  // [rad/s]
  Scene scene = weightlessSheet(2, 2, 0.02, 0.02);
  pin(scene, 0, 1, 0, 1);
  scene.cloth.pins[0].turn = Vec3(0.0, kRate, 0.0);
  scene.cloth.pins[0].centre = scene.cloth.pose.position;
  ClothWorld world(scene);
  const double turn = kRate * scene.solver.time_step;
  world.step();  // begins at rest
  for (int step = 1; step <= 50; ++step) {
    world.step();
    const Vec3 normal = world.cloth().internal().normal(0);
    const Vec3 middle = Eigen::AngleAxisd((step + 0.5) * turn, Vec3::UnitY()) * Vec3::UnitZ();
    ASSERT_LE((normal - middle).norm(), tolerance(std::pow(turn, 3))) << step;
  }
}

class TurnedSheet : public testing::TestWithParam<Integrator> {};

/// A sheet held by two columns or rows at each side turns about an axis far away.
TEST_P(TurnedSheet, KeepsItsShape) {
  constexpr double kSide = 0.06, kRate = 0.5, kArm = 0.1;  // [m], [rad/s], [m]
  Scene scene = weightlessSheet(13, 13, kSide, kSide);
  scene.solver.integrator = GetParam();
  pin(scene, 0, 1, 0, 12);
  pin(scene, 11, 12, 0, 12);
  pin(scene, 0, 12, 0, 1);
  pin(scene, 0, 12, 11, 12);
  for (Pin& pin : scene.cloth.pins) {
    pin.turn = Vec3(0.0, kRate, 0.0);
    pin.centre = Vec3(0.0, 0.0, kArm);
    pin.velocity = Vec3(0.0, 0.01, 0.0);
  }
  Simulation simulation(scene);
  std::vector<Vec3> start, end;
  simulation.positions(start);
  run(simulation, 1.0);
  simulation.positions(end);
  const double time = simulation.time();
  const Quat turned(Eigen::AngleAxisd(kRate * time, Vec3::UnitY()));
  double pinned = 0.0, free = 0.0;
  for (int p = 0; p < 169; ++p) {
    const Vec3 centre(0.0, 0.0, kArm);
    const Vec3 rigid = centre + turned * (start[p] - centre) + time * Vec3(0.0, 0.01, 0.0);
    const int i = p % 13, j = p / 13;
    double& off = i > 1 && i < 11 && j > 1 && j < 11 ? free : pinned;
    off = std::max(off, (end[p] - rigid).norm());
  }
  EXPECT_LE(pinned, tolerance(1e-14));
  // Its sides start at once, and its middle then rings with at most v/ω₁, where ω₁ = 36 √(B/ρ)/l² for a
  // clamped square [Leissa 1969, Vibration of plates]. The centrifugal force adds less than a hundredth.
  const double span = kSide * 9.0 / 12.0, speed = std::hypot(kRate * kArm, 0.01);
  const double ringing = speed * span * span / (36.0 * std::sqrt(1e-5 / 0.15));
  EXPECT_LE(free, tolerance(ringing));
  const EnergyReport energy = simulation.energy();
  const double kinetic = 0.5 * simulation.mass() * speed * speed;
  EXPECT_NEAR(energy.kinetic, kinetic, tolerance(0.05 * kinetic));  // r differs from the arm at the sides
  // The sudden start may make it ring with ½ m v²; a tenth of that amplitude is left.
  EXPECT_LE(energy.stretch + energy.bend + energy.shear, tolerance(1e-2 * kinetic));
  EXPECT_GE(energy.dissipated, -tolerance(1e-3 * kinetic));
}

INSTANTIATE_TEST_SUITE_P(Integrators, TurnedSheet, testing::Values(Integrator::Euler, Integrator::Bdf2),
                         [](const auto& info) { return info.param == Integrator::Euler ? "euler" : "bdf2"; });

class PulledStrip : public testing::TestWithParam<Strategy> {};

/// A strip is stretched by 1 % within a second. Its work is ½ k ε² A; end forces of N steps give 1/N
/// more.
TEST_P(PulledStrip, StoresTheWorkOfItsPins) {
  constexpr double kLength = 0.1, kWidth = 0.04, kStrain = 0.01;
  Scene scene = weightlessSheet(17, 9, kLength, kWidth);
  setStrategy(scene, GetParam(), 2);
  pin(scene, 0, 0, 0, 8);
  pin(scene, 16, 16, 0, 8);
  scene.cloth.pins[1].velocity = Vec3(kStrain * kLength, 0.0, 0.0);
  Simulation simulation(scene);
  run(simulation, 1.0);
  const EnergyReport energy = simulation.energy();
  const double stored = 0.5 * 1000.0 * kStrain * kStrain * kLength * kWidth;
  EXPECT_NEAR(energy.stretch, stored, tolerance(1e-3 * stored));
  EXPECT_NEAR(energy.work, stored, tolerance(3e-3 * stored));
  EXPECT_NEAR(energy.dissipated, 0.0, tolerance(3e-3 * stored));
}

INSTANTIATE_TEST_SUITE_P(Strategies, PulledStrip, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

/// Cloth that is pinned everywhere is lifted: m g Δz and ½ m v², to rounding.
TEST(MovingPins, LiftTheWeight) {
  Scene scene = sheetScene(makeFabric(stiffFabric()), 5, 5, 0.1, 0.1);
  pin(scene, 0, 4, 0, 4);
  scene.cloth.pins[0].velocity = Vec3(0.0, 0.0, 0.1);
  Simulation simulation(scene);
  const double before = simulation.energy().total();
  run(simulation, 0.5);
  const double gained = simulation.mass() * (9.81 * 0.05 + 0.5 * 0.1 * 0.1);
  EXPECT_NEAR(simulation.energy().work, gained, tolerance(1e-9 * gained));
  EXPECT_NEAR(simulation.energy().total() - before, gained, tolerance(1e-9 * gained));
  EXPECT_NEAR(particle(simulation, 2, 2).z(), 0.05, tolerance(1e-15));
}

/// Cloth that is pinned everywhere turns in air. Its pins carry its weight, its centripetal force and its
/// drag, and their work is that of the drag. Steps turn by 5 mrad; the force is that of their middle.
TEST(MovingPins, CarryInertiaAndDrag) {
  constexpr double kRate = 5.0, kArm = 0.2, kDrag = 3.0;  // [rad/s], [m], [1/s]
  Scene scene = sheetScene(makeFabric(stiffFabric()), 9, 9, 0.1, 0.1);
  scene.air_damping = kDrag;
  pin(scene, 0, 8, 0, 8);
  scene.cloth.pins[0].turn = Vec3(0.0, 0.0, kRate);
  scene.cloth.pins[0].centre = scene.cloth.pose.position - Vec3(kArm, 0.0, 0.0);
  Simulation simulation(scene);
  run(simulation, 0.25);
  const EnergyReport before = simulation.energy();
  run(simulation, 0.5);
  const double turn = kRate * scene.solver.time_step, mass = simulation.mass(), speed = kRate * kArm;
  const Vec3 force = simulation.supportForce();
  const Vec3 along = Eigen::AngleAxisd(kRate * simulation.time(), Vec3::UnitZ()) * Vec3::UnitX();
  const Vec3 across = Vec3::UnitZ().cross(along);
  const double inertia = mass * kRate * speed, drag = kDrag * mass * speed;
  EXPECT_NEAR(force.z(), mass * 9.81, tolerance(1e-9 * mass * 9.81));
  EXPECT_NEAR(-force.dot(along), inertia, tolerance(turn * (inertia + drag)));
  EXPECT_NEAR(force.dot(across), drag, tolerance(turn * (inertia + drag)));
  // Nodes farther out are faster: the mean square of a radius is larger by the moment of inertia.
  const double square = 1.0 + 2.0 * 0.1 * 0.1 / 12.0 / (kArm * kArm) * 65.0 / 64.0;
  const double lost = 0.25 * drag * speed * square;
  EXPECT_NEAR(simulation.energy().dissipated - before.dissipated, lost, tolerance(0.01 * lost));
}

/// A motion slower than the speed of sleep is still made.
TEST(MovingPins, DoNotLetStepsBeSkipped) {
  Scene scene = sheetScene(makeFabric(stiffFabric()), 9, 9, 0.1, 0.1);
  pinAllSides(scene);
  scene.air_damping = 5.0;
  for (Pin& pin : scene.cloth.pins) pin.velocity = Vec3(0.0, 1e-5, 0.0);
  Simulation simulation(scene);
  const Vec3 edge = particle(simulation, 0, 4);
  run(simulation, 2.0);
  const Vec3 middle = particle(simulation, 4, 4);
  run(simulation, 4.0);
  EXPECT_NEAR(particle(simulation, 0, 4).y() - edge.y(), 4e-5, tolerance(1e-15));
  // The middle follows within what sleep hides: three times the tolerance, 0.3 g of force.
  EXPECT_NEAR(particle(simulation, 4, 4).y() - middle.y(), 2e-5, tolerance(2e-6));
}

TEST(MovingPins, FirstPinOfAParticleCounts) {
  Scene scene = weightlessSheet(5, 5, 0.1, 0.1);
  pin(scene, 0, 0, 0, 0);
  pin(scene, 0, 0, 0, 4);
  scene.cloth.pins[1].velocity = Vec3(-0.01, 0.0, 0.0);
  Simulation simulation(scene);
  const Vec3 first = particle(simulation, 0, 0), second = particle(simulation, 0, 1);
  run(simulation, 0.1);
  EXPECT_EQ(particle(simulation, 0, 0), first);
  EXPECT_NEAR(particle(simulation, 0, 1).x(), second.x() - 0.001, tolerance(1e-15));
}

/// A probe holds back one of two pins of a sheet. It waits while the other goes on; then it catches up, no
/// faster than twice its speed (docs/reference/scenes.md).
TEST(MovingPins, WaitAloneAndCatchUpSlowly) {
  constexpr double kSpeed = 0.1, kFreed = 0.1;  // [m/s], [s]
  Scene scene = weightlessSheet(9, 9, 0.1, 0.1);
  pin(scene, 0, 0, 0, 8);
  pin(scene, 8, 8, 0, 8);
  for (Pin& pin : scene.cloth.pins) pin.velocity = Vec3(0.0, 0.0, kSpeed);
  Simulation simulation(scene);
  const ProbeOptions& probe = scene.probes[0];
  const double h = scene.solver.time_step;
  double behind = 0.0, fastest = 0.0, before = 0.0;
  while (simulation.time() < 3.0 * kFreed - 1e-9) {
    if (simulation.time() < kFreed) {
      simulation.setDevice(Vec3(-0.05, 0.0, probe.radius + 2e-3), Vec3::Zero());
    } else {
      simulation.removeDevice();
    }
    ASSERT_FALSE(simulation.step().failed);
    const double z = particle(simulation, 0, 4).z();
    behind = std::max(behind, kSpeed * simulation.time() - z);
    fastest = std::max(fastest, (z - before) / h);
    before = z;
    EXPECT_NEAR(particle(simulation, 8, 4).z(), kSpeed * simulation.time(), 1e-12);
  }
  EXPECT_GT(behind, 0.2 * kSpeed * kFreed);  // the pin pushes the proxy, too
  EXPECT_NEAR(fastest, 2.0 * kSpeed, tolerance(1e-9 * kSpeed));
  EXPECT_NEAR(before, kSpeed * simulation.time(), 1e-12) << "it has caught up";
}

TEST(MovingPins, ContinueFromAState) {
  Scene scene = weightlessSheet(9, 9, 0.1, 0.1);
  setStrategy(scene, Strategy::Amrc, 2);
  pin(scene, 0, 0, 0, 8);
  pin(scene, 8, 8, 0, 8);
  scene.cloth.pins[1].turn = Vec3(3.0, 0.0, 0.0);
  Simulation whole(scene), resumed(scene);
  run(whole, 0.1);
  const std::string saved = whole.saveState();
  run(whole, 0.2);
  resumed.loadState(saved, "state");
  run(resumed, 0.2);
  EXPECT_EQ(resumed.stateHash(), whole.stateHash());
  scene.cloth.pins[1].turn = Vec3(3.5, 0.0, 0.0);
  Simulation other(scene);
  EXPECT_THROW(other.loadState(saved, "state"), InputError);
}

}  // namespace
}  // namespace haptic_cloth::moving_pins_test
