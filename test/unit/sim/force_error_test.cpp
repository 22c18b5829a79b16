/// Parts of the estimate of a probe force's error. Criterion where no other is named: rounding.
#include "sim/force_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth::force_error_test {
namespace {

const Vec3 kNothing = Vec3::Zero();

class ForceErrorTest : public testing::Test {
 protected:
  ForceErrorTest() : scene_(sheetScene(makeFabric(LinearFabric()), 9, 9, 0.1, 0.1)), error_(scene_) {}

  double estimate(double unbalanced, const Vec3& before, const Vec3& force, double moved = 0.0) {
    return error_.estimate(0, moved, unbalanced, before, force);
  }

  Scene scene_;
  ForceError error_;
};

TEST_F(ForceErrorTest, IsZeroWithoutContact) {
  EXPECT_EQ(estimate(1.0, kNothing, kNothing), 0.0);
  EXPECT_GT(estimate(0.0, Vec3(0, 0, 1), kNothing), 0.0) << "contact ended in this step";
}

/// Criterion: of 1 N that 1e-9 N should balance, all is left.
TEST_F(ForceErrorTest, IsTheForceThatIsNotBalanced) {
  const Vec3 weak(0, 0, 1e-9);
  EXPECT_NEAR(estimate(1.0, weak, weak), 1.0, 1e-12);
}

/// Half of it is remembered while the probe rests, and forgotten after a radius of motion, or without
/// contact.
TEST_F(ForceErrorTest, StaysWhileTheProbeRests) {
  const Vec3 weak(0, 0, 1e-9);
  estimate(1.0, weak, weak);
  for (int step = 0; step < 1000; ++step) EXPECT_NEAR(estimate(0.0, weak, weak), 0.5, 1e-12);
  const double radius = scene_.probes[0].radius;
  EXPECT_NEAR(estimate(0.0, weak, weak, 0.02 * radius), 0.5 / std::exp(1.0), 1e-12);
  EXPECT_LT(estimate(0.0, weak, weak, radius), 1e-9);
  estimate(1.0, weak, weak);
  estimate(0.0, kNothing, kNothing);
  EXPECT_LT(estimate(0.0, weak, weak), 1e-9);
}

TEST_F(ForceErrorTest, AProbeThatReturnsIsANewOne) {
  const Vec3 weak(0, 0, 1e-9);
  estimate(1.0, weak, weak);
  error_.forget(0);
  EXPECT_LT(estimate(0.0, weak, weak), 1e-9);
}

/// A force that has just begun is less certain than one that stays, in any direction.
TEST_F(ForceErrorTest, GrowsWithTheChangeOfTheForce) {
  const Vec3 force(0, 0, 1);
  const double steady = estimate(0.0, force, force);
  EXPECT_GT(steady, 0.0);
  EXPECT_GT(estimate(0.0, kNothing, force), 2.0 * steady);
  EXPECT_DOUBLE_EQ(estimate(0.0, kNothing, force), estimate(0.0, Vec3(1, 0, 1), force));
}

/// Strip held at one end, without a probe.
Scene stripScene(Strategy strategy, bool hangs) {
  LinearFabric linear;
  linear.rigidity = 1e-4;
  Scene scene = sheetScene(makeFabric(linear), 17, 5, 0.16, 0.04);
  setStrategy(scene, strategy, 2);
  pin(scene, 0, 0, 0, 4);
  if (hangs) hangDown(scene);
  return scene;
}

/// Energies of a strip that stretches or bends under its weight after 0.1 s.
ForceError::CoarseEnergy coarseEnergyOf(Strategy strategy, bool hangs) {
  ClothWorld world(stripScene(strategy, hangs));
  for (int step = 0; step < 100; ++step) world.step();
  return ForceError::coarseEnergy(world.cloth());
}

TEST(CoarseEnergy, IsZeroOnTheFinestMesh) {
  const ForceError::CoarseEnergy energy = coarseEnergyOf(Strategy::Finest, false);
  EXPECT_EQ(energy.stretch, 0.0);
  EXPECT_EQ(energy.bend, 0.0);
  EXPECT_GT(energy.whole, 0.0);
}

/// Cells of level 2 are 4 cells of the finest grid long: (l/l₀)² - 1 = 15. Those at the pins are smaller.
TEST(CoarseEnergy, CountsStretchAndBending) {
  const ForceError::CoarseEnergy flat = coarseEnergyOf(Strategy::Coarsest, true);
  EXPECT_GT(flat.stretch, flat.whole) << "stretched by its weight";
  EXPECT_LT(flat.stretch, 15.0 * flat.whole);
  EXPECT_GT(coarseEnergyOf(Strategy::Coarsest, false).bend, 0.0);
}

/// Estimate for a force of `size` at a coupling of `stiffness` on a hanging strip of coarse cells.
double estimateFor(double stiffness, double size) {
  Scene scene = stripScene(Strategy::Coarsest, true);
  scene.probes[0].coupling_stiffness = stiffness;
  ClothWorld world(scene);
  for (int step = 0; step < 100; ++step) world.step();
  ForceError error(scene);
  error.noteCloth(world.cloth(), true, false);
  return error.estimate(0, 0.0, 0.0, Vec3(0, 0, size), Vec3(0, 0, size));
}

/// Coarse stretched cells: a share of the force while it is small, at any stiffness of the coupling,
/// and no more than what the coupling's spring makes of their energy.
TEST(CoarseEnergy, IsFeltAsAShareOfTheForceUpToTheCoupling) {
  const ForceError::CoarseEnergy flat = coarseEnergyOf(Strategy::Coarsest, true);
  const double small = estimateFor(400, 1e-6);
  EXPECT_NEAR(small, std::hypot(0.012 * flat.stretch / flat.whole, 0.015) * 1e-6, 1e-9 * small);
  EXPECT_DOUBLE_EQ(estimateFor(100, 1e-6), small);
  // 1 N: its share is far above the spring's part, 1e-9 N², and its square rounds to less than 1e-19 N².
  const double rest = 0.015 * 1.0;
  const auto spring = [&](double stiffness) {
    const double estimate = estimateFor(stiffness, 1.0);
    return estimate * estimate - rest * rest;
  };
  EXPECT_NEAR(spring(400) / spring(100), 4.0, 1e-6);
}

/// Coarse cells are measured when a probe begins to feel the cloth, then at decisions, else never.
TEST(CoarseEnergy, IsMeasuredWhileItIsFelt) {
  const Scene scene = stripScene(Strategy::Coarsest, false);
  ClothWorld world(scene);
  for (int step = 0; step < 100; ++step) world.step();
  const Vec3 force(0, 0, 1e-6);
  ForceError error(scene);
  const auto estimate = [&] { return error.estimate(0, 0.0, 0.0, force, force); };
  const double without = estimate();
  error.noteCloth(world.cloth(), false, true);
  EXPECT_EQ(estimate(), without) << "nothing felt";
  error.noteCloth(world.cloth(), true, false);
  const double first = estimate();
  EXPECT_GT(first, without);
  for (int step = 0; step < 100; ++step) world.step();
  error.noteCloth(world.cloth(), true, false);
  EXPECT_EQ(estimate(), first) << "no decision";
  error.noteCloth(world.cloth(), true, true);
  EXPECT_NE(estimate(), first);
}

/// Unbalanced force near a probe that is pressed 5 mm into a sheet held at its sides [N].
double unbalancedAfter(int iterations) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 17, 17, 0.16, 0.16);
  pinAllSides(scene);
  scene.solver.minimizer.tolerance = 1e-3;
  scene.solver.minimizer.max_iterations = iterations;
  ClothWorld world(scene);
  const double height = scene.probes[0].radius + scene.cloth.fabric.thickness;
  for (int step = 1; step <= 100; ++step) {
    world.setDevice(0, {Vec3(0, 0, height - 1e-4 * step + 0.005), Vec3(0, 0, -0.1)});
    world.step();
  }
  return ForceError(scene).unbalancedForce(0, world.objective(), world.cloth().mesh());
}

/// A solve to a tolerance leaves at most tolerance times the weight of the sheet, by the triangle
/// and the Cauchy-Schwarz inequality; one that is cut short leaves more.
TEST(UnbalancedForce, VanishesWithTheSolve) {
  const double weight = LinearFabric().areal_density * 0.16 * 0.16 * 9.80665;
  EXPECT_LE(unbalancedAfter(2000), 1e-3 * weight);
  EXPECT_GT(unbalancedAfter(2), 10.0 * unbalancedAfter(2000));
}

/// A solve that ends before the spring of the coupling is balanced says so, by the law of the spring.
TEST(UnbalancedForce, CountsTheProxy) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 17, 17, 0.16, 0.16);
  pinAllSides(scene);
  scene.solver.minimizer.max_iterations = 1;
  scene.solver.minimizer.preconditioner = Preconditioner::None;
  scene.probes[0].coupling_damping = 0.0;
  ClothWorld world(scene);
  const double height = scene.probes[0].radius + scene.cloth.fabric.thickness;
  world.setDevice(0, {Vec3(0, 0, height), kNothing});
  world.step();
  world.setDevice(0, {Vec3(0, 0, height - 0.005), kNothing});
  world.step();
  const ProbeReport& probe = world.probes()[0];
  const Vec3 left = probe.force - scene.probes[0].coupling_stiffness * (probe.proxy - probe.device);
  EXPECT_GT(left.norm(), 0.1);
  EXPECT_GE(ForceError(scene).unbalancedForce(0, world.objective(), world.cloth().mesh()),
            (1.0 - 1e-9) * left.norm());
  EXPECT_GE(probe.force_error, (1.0 - 1e-9) * left.norm());
}

}  // namespace
}  // namespace haptic_cloth::force_error_test
