/// A probe pressed into a square membrane held on its four sides.
/// Criteria: balance of forces (supports carry weight and probe), and the finite-element table of a
/// frictionless sphere of radius 0.1 a pressed δ deep into a membrane of side 2a, G/E = 0.5, ν = 0:
/// F/(E a) = 8.437e-4 at δ/a = 0.1 and 6.923e-3 at 0.2 (docs/validation.md, good to 0.5 %).
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

constexpr double kHalfSide = 0.1;  // a [m]
constexpr double kRadius = 0.01;   // 0.1 a [m]

Scene membrane(Strategy strategy) {
  LinearFabric linear;
  linear.stiffness = 1000.0;
  linear.shear_modulus = 500.0;
  Scene scene = sheetScene(makeFabric(linear), 65, 65, 2.0 * kHalfSide, 2.0 * kHalfSide);
  setStrategy(scene, strategy, 2);
  pinAllSides(scene);
  scene.probe.radius = kRadius;
  scene.probe.friction = 0.0;
  scene.probe.coupling_stiffness = 2000.0;
  quasiStatic(scene, 10.0, 2e-3, 1e-3);
  return scene;
}

/// Lowers the device to `depth` [m] of its lowest point below the flat sheet in 0.2 s and waits for rest.
void press(Simulation& simulation, double depth) {
  const double h = simulation.scene().solver.time_step, duration = 0.2;
  const double from = kRadius + 0.002, to = kRadius - depth;
  const Vec3 velocity(0.0, 0.0, (to - from) / duration);
  for (double t = h; t < duration + 0.5 * h; t += h) {
    simulation.setDevice(Vec3(0.0, 0.0, from) + t * velocity, velocity);
    simulation.step();
  }
  const Vec3 device(0.0, 0.0, to);
  settle(simulation, 1e-3, 1.0, &device);
}

class PressedMembrane : public testing::TestWithParam<Strategy> {};

TEST_P(PressedMembrane, ForcesBalance) {
  Scene scene = membrane(GetParam());
  Simulation simulation(scene);
  press(simulation, 0.02);
  const ProbeReport probe = simulation.probe();
  ASSERT_TRUE(probe.present);
  EXPECT_TRUE(probe.contact);
  EXPECT_GT(probe.force.z(), 0.1) << "the cloth pushes the probe back up";
  const double total = probe.force.z() + simulation.mass() * 9.81;
  EXPECT_NEAR(simulation.supportForce().z(), total, tolerance(0.01 * total));
  EXPECT_NEAR(probe.force.head<2>().norm(), 0.0, tolerance(0.01 * total));
  // At rest the virtual coupling carries the same force.
  const Vec3 spring = scene.probe.coupling_stiffness * (probe.proxy - probe.device);
  EXPECT_NEAR((spring - probe.force).norm(), 0.0, tolerance(0.01 * total));
}

TEST_P(PressedMembrane, MatchesFiniteElements) {
  Scene scene = membrane(GetParam());
  scene.gravity = Vec3(0.0, 0.0, -1e-3);  // the tolerance is measured in |g|: not zero
  scene.solver.minimizer.tolerance = 10.0;
  Simulation simulation(scene);
  press(simulation, 0.02);
  const ProbeReport probe = simulation.probe();
  // Depth of the sheet's middle: the contact's finite gap belongs to the contact, not to the membrane.
  const double depth = -particle(simulation, 32, 32).z() / kHalfSide;
  const double force = probe.force.z() / (1000.0 * kHalfSide);
  // F grows as a power of δ between the two entries of the table.
  const double power = std::log(6.923e-3 / 8.437e-4) / std::log(2.0);
  const double exact = 6.923e-3 * std::pow(depth / 0.2, power);
  std::cout << "  depth/a " << depth << " force/(E a) " << force << " error " << 100.0 * (force / exact - 1.0)
            << " %\n";
  EXPECT_NEAR(depth, 0.2, 0.005);
  // Spacing 0.03 a against a radius of 0.1 a, and 0.5 % of the table itself.
  EXPECT_NEAR(force, exact, tolerance(0.03 * exact));
}

INSTANTIATE_TEST_SUITE_P(Strategies, PressedMembrane, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

TEST(Probe, FeelsNothingInTheAir) {
  Simulation simulation(membrane(Strategy::Finest));
  const Vec3 away(0.0, 0.0, 0.1);
  for (int n = 0; n < 10; ++n) {
    simulation.setDevice(away, Vec3::Zero());
    simulation.step();
  }
  EXPECT_FALSE(simulation.probe().contact);
  EXPECT_LE(simulation.probe().force.norm(), tolerance(1e-9));
  EXPECT_LE((simulation.probe().proxy - away).norm(), tolerance(1e-9));
  simulation.removeDevice();
  simulation.step();
  EXPECT_FALSE(simulation.probe().present);
  EXPECT_EQ(simulation.probe().force.norm(), 0.0);
}

}  // namespace
}  // namespace haptic_cloth
