/// Parts of the estimate of a probe force's error. Criterion where no other is named: rounding.
#include "sim/force_error.h"

#include <gtest/gtest.h>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth {
namespace {

const Vec3 kNothing = Vec3::Zero();

class ForceErrorTest : public testing::Test {
 protected:
  ForceErrorTest() : scene_(sheetScene(makeFabric(LinearFabric()), 9, 9, 0.1, 0.1)), error_(scene_) {}

  double estimate(const Vec3& unbalanced, const Vec3& before, const Vec3& force) const {
    return error_.estimate(0, unbalanced, before, force);
  }

  Scene scene_;
  ForceError error_;
};

TEST_F(ForceErrorTest, IsZeroWithoutContact) {
  EXPECT_EQ(estimate(Vec3(0, 0, 1), kNothing, kNothing), 0.0);
  EXPECT_GT(estimate(kNothing, Vec3(0, 0, 1), kNothing), 0.0) << "contact ended in this step";
}

/// What is left of 1 N after 1e-9 N of force is the unbalanced force itself, in any direction.
TEST_F(ForceErrorTest, IsTheForceThatIsNotBalanced) {
  const Vec3 weak(0, 0, 1e-9);
  EXPECT_NEAR(estimate(Vec3(0, 0, 1), weak, weak), 1.0, 1e-12);
  EXPECT_NEAR(estimate(Vec3(0, -1, 0), weak, weak), 1.0, 1e-12);
}

/// A force that has just begun is less certain than one that stays, in any direction.
TEST_F(ForceErrorTest, GrowsWithTheChangeOfTheForce) {
  const Vec3 force(0, 0, 1);
  const double steady = estimate(kNothing, force, force);
  EXPECT_GT(steady, 0.0);
  EXPECT_GT(estimate(kNothing, kNothing, force), 2.0 * steady);
  EXPECT_DOUBLE_EQ(estimate(kNothing, kNothing, force), estimate(kNothing, Vec3(1, 0, 1), force));
}

/// Energy of coarse cells, of a strip that stretches or bends under its weight after 0.1 s.
double coarseEnergyOf(Strategy strategy, bool hangs) {
  LinearFabric linear;
  linear.rigidity = 1e-4;
  Scene scene = sheetScene(makeFabric(linear), 17, 5, 0.16, 0.04);
  setStrategy(scene, strategy, 2);
  pin(scene, 0, 0, 0, 4);
  if (hangs) hangDown(scene);
  ClothWorld world(scene);
  for (int step = 0; step < 100; ++step) world.step();
  return ForceError::coarseEnergy(world.cloth());
}

TEST(CoarseEnergy, IsZeroOnTheFinestMesh) { EXPECT_EQ(coarseEnergyOf(Strategy::Finest, false), 0.0); }

TEST(CoarseEnergy, CountsStretchAndBending) {
  EXPECT_GT(coarseEnergyOf(Strategy::Coarsest, true), 0.0) << "stretched by its weight, flat";
  EXPECT_GT(coarseEnergyOf(Strategy::Coarsest, false), coarseEnergyOf(Strategy::Coarsest, true));
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
  return ForceError(scene).unbalancedForce(0, world.objective(), world.cloth().mesh()).norm();
}

/// A solve to a tolerance leaves at most tolerance times the weight of the sheet, by the triangle
/// and the Cauchy-Schwarz inequality; one that is cut short leaves more.
TEST(UnbalancedForce, VanishesWithTheSolve) {
  const double weight = LinearFabric().areal_density * 0.16 * 0.16 * 9.80665;
  EXPECT_LE(unbalancedAfter(2000), 1e-3 * weight);
  EXPECT_GT(unbalancedAfter(2), 10.0 * unbalancedAfter(2000));
}

}  // namespace
}  // namespace haptic_cloth
