/// Splits and merges of a twisted cell.
/// Criteria: a sheet z = τ x y is straight along its threads, so it turns nowhere. Opposite sides differ in
/// direction by twice the angle whose tangent is τ w/2, w the width of a cell, so its middle lines are
/// shorter than its sides by 1 - 1/√(1 + (τ w/2)²). At the thresholds of strain the cell splits, or its four
/// parts no longer merge (docs/model.md, The adaptive mesh), here within 1 %.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth {
namespace {

constexpr double kSize = 0.1;  // of the cell [m]

/// Decides about a cell of two finest cells' width whose middle lines are shorter by a strain.
StepReport decide(StartMesh start, double shorter) {
  Scene scene = sheetScene(makeFabric({}), 3, 3, kSize, kSize);
  setStrategy(scene, Strategy::Amrc, 1);
  scene.adapt.start = start;
  scene.adapt.minimum_age = 0;
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

}  // namespace
}  // namespace haptic_cloth
