/// Splits and merges of a twisted cell.
/// Criteria: a sheet z = τ x y is straight along its threads, so it turns nowhere. Opposite sides differ in
/// direction by twice the angle whose tangent is τ w/2, w the width of a cell, so its middle lines are
/// shorter than its sides by 1 - 1/√(1 + (τ w/2)²). At the thresholds of strain the cell splits, or its four
/// parts no longer merge (docs/model.md, The adaptive mesh), here within 1 %. Far from probes that touch
/// cloth both thresholds are larger by `far_strain_factor`: more than `near_reach` spacings beyond the ball
/// in which cells stay finest (the same section).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth::mesh_decisions_test {
namespace {

constexpr double kSize = 0.1;  // of the cell [m]

/// Decides about a cell of two finest cells' width whose middle lines are shorter by a strain.
/// @param factor `far_strain_factor`; there is no probe
StepReport decide(StartMesh start, double shorter, double factor = 1.0) {
  Scene scene = sheetScene(makeFabric({}), 3, 3, kSize, kSize);
  setStrategy(scene, Strategy::Amrc, 1);
  scene.adapt.start = start;
  scene.adapt.minimum_age = 0;
  scene.adapt.far_strain_factor = factor;
  scene.gravity = Vec3::Zero();
  ClothWorld world(scene);
  const double twist = std::sqrt(std::pow(1.0 - shorter, -2) - 1.0) / (0.5 * kSize);
  std::vector<Vec3> positions = world.cloth().state().position;
  for (Vec3& x : positions) x.z() += twist * x.x() * x.y();
  world.setPositions(positions);
  return world.step();
}

TEST(MeshDecisions, ATwistedCellSplits) {
  const double limit = AdaptOptions().refine_above_strain;
  EXPECT_EQ(decide(StartMesh::Coarsest, 0.99 * limit).refined, 0);
  EXPECT_EQ(decide(StartMesh::Coarsest, 1.01 * limit).refined, 1);
}

TEST(MeshDecisions, ATwistedCellDoesNotMerge) {
  const double limit = AdaptOptions().coarsen_below_strain;
  EXPECT_EQ(decide(StartMesh::Finest, 0.99 * limit).coarsened, 1);
  EXPECT_EQ(decide(StartMesh::Finest, 1.01 * limit).coarsened, 0);
}

/// Split cells of a wrung strip under a probe at its left end. Near the probe each would split, far from it
/// none.
/// @param height of the probe's surface above the strip [m] @param within number of cells near the probe
int splitsOfWrungStrip(double height, double near_reach, int& within) {
  constexpr int kColumns = 65;
  constexpr double kSpacing = 0.01, kFarFactor = 2.0;
  Scene scene = sheetScene(makeFabric({}), kColumns, 3, (kColumns - 1) * kSpacing, 2.0 * kSpacing);
  setStrategy(scene, Strategy::Amrc, 1);
  scene.adapt.start = StartMesh::Coarsest;
  scene.adapt.interval = 1;
  scene.cloth.fabric.areal_density = 5.0;  // so heavy that the probe does not push it away in its first step
  scene.adapt.far_strain_factor = kFarFactor;
  scene.adapt.near_reach = near_reach;
  scene.gravity = Vec3::Zero();
  ClothWorld world(scene);
  std::vector<Vec3> positions = world.cloth().state().position;
  const double left = positions.front().x(), radius = scene.probes[0].radius;
  // A probe feels cloth once it has been clear of it.
  Vec3 device;
  for (int step = 0; step < 60 && !world.probes()[0].contact; ++step) {
    device = Vec3(left, 0.0, radius + std::max(height, 0.05 - 0.001 * step));
    world.setDevice(0, {device, Vec3::Zero()});
    world.step();
  }
  EXPECT_EQ(world.probes()[0].contact, height < 0.0);

  // Lines across the strip turn by so much per length that middle lines are shorter by 1.5 times the
  // threshold.
  const double turn = std::sqrt(3.0 * scene.adapt.refine_above_strain) / kSpacing;
  for (Vec3& x : positions) {
    const double angle = turn * (x.x() - left);
    x = Vec3(x.x(), x.y() * std::cos(angle), x.y() * std::sin(angle));
  }
  world.setPositions(positions);
  const Vec3 proxy = world.probes()[0].proxy;
  const double ahead = std::min((device - proxy).norm(), 2.0 * kSpacing);
  within = 0;
  for (double x = left + kSpacing; x < -left; x += 2.0 * kSpacing) {
    const double reach = radius + (2.0 + near_reach) * kSpacing + ahead + 0.71 * 2.0 * kSpacing;
    if ((Vec3(x, 0.0, 0.0) - proxy).norm() < reach) ++within;
  }
  world.step();
  std::vector<Cell> leaves;
  world.cloth().leaves().leaves(leaves);
  return (static_cast<int>(leaves.size()) - (kColumns - 1) / 2) / 3;
}

TEST(MeshDecisions, FarFactorsCountFarFromAProbeThatTouches) {
  int within = 0;
  // The load of the touch alone splits cells up to 0.1 m away, the least reach here.
  for (const double near_reach : {6.0, 10.0, 20.0}) {
    EXPECT_EQ(splitsOfWrungStrip(-0.001, near_reach, within), within) << near_reach;
    EXPECT_GT(within, 0);
    EXPECT_LT(within, 32);
  }
  EXPECT_EQ(splitsOfWrungStrip(0.04, 8.0, within), 0) << "it touches nothing";
}

TEST(MeshDecisions, AFarFactorCountsForMergesToo) {
  const double split = AdaptOptions().refine_above_strain, merge = AdaptOptions().coarsen_below_strain;
  EXPECT_EQ(decide(StartMesh::Coarsest, 1.99 * split, 2.0).refined, 0);
  EXPECT_EQ(decide(StartMesh::Coarsest, 2.01 * split, 2.0).refined, 1);
  EXPECT_EQ(decide(StartMesh::Finest, 1.99 * merge, 2.0).coarsened, 1);
  EXPECT_EQ(decide(StartMesh::Finest, 2.01 * merge, 2.0).coarsened, 0);
}

}  // namespace
}  // namespace haptic_cloth::mesh_decisions_test
