/// Mesh changes between layers that press on each other, in every step.
/// Criteria: no crossing after any step (contact/crossings.h); no cell merges beside one that is split
/// (decision 0034), because both would move the surface between them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "contact/crossings.h"
#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth::folded_mesh_test {
namespace {

/// Level of the leaf around each finest cell.
std::vector<int> levels(const ClothWorld& world) {
  const Grid& grid = world.cloth().grid();
  std::vector<int> levels(grid.cells());
  for (const Patch& patch : world.cloth().mesh().patches) {
    const Cell& cell = patch.cell;
    for (int j = cell.j; j < cell.j + cell.span(); ++j) {
      for (int i = cell.i; i < cell.i + cell.span(); ++i) levels[grid.cell(i, j)] = cell.level;
    }
  }
  return levels;
}

/// Number of pairs of finest cells beside each other of which one was merged and the other was split.
int mergesBesideSplits(const Grid& grid, const std::vector<int>& before, const std::vector<int>& after) {
  int count = 0;
  const auto change = [&](int i, int j) { return after[grid.cell(i, j)] - before[grid.cell(i, j)]; };
  for (int j = 0; j < grid.rows - 1; ++j) {
    for (int i = 0; i < grid.columns - 1; ++i) {
      if (i + 1 < grid.columns - 1 && change(i, j) * change(i + 1, j) < 0) ++count;
      if (j + 1 < grid.rows - 1 && change(i, j) * change(i, j + 1) < 0) ++count;
    }
  }
  return count;
}

TEST(FoldedMesh, NeverSplitsBesideAMergeOrCrosses) {
  Scene scene = foldedSheet(33);
  scene.adapt.interval = 1;
  scene.adapt.minimum_age = 0;
  ClothWorld world(scene);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> power(-3.0, -0.5);
  int pressed = 0, both = 0;
  for (int step = 0; step < 200; ++step) {
    AdaptOptions adapt = scene.adapt;
    // All finest cells may merge, and of the others those above a random threshold split.
    adapt.refine_above = std::pow(10.0, power(random));
    adapt.refine_above_strain = 0.1 * adapt.refine_above;
    adapt.coarsen_below = adapt.coarsen_below_strain = 10.0;
    world.setAdaptOptions(adapt);
    const std::vector<int> before = levels(world);
    const StepReport report = world.step();
    EXPECT_FALSE(report.failed) << "step " << step;
    EXPECT_EQ(mergesBesideSplits(world.cloth().grid(), before, levels(world)), 0) << "step " << step;
    pressed += report.self_contacts > 0 ? 1 : 0;
    both += report.refined > 0 && report.coarsened > 0 ? 1 : 0;
    ASSERT_EQ(findCrossings(world.cloth().mesh(), world.cloth().nodes()).pairs, 0) << "step " << step;
  }
  EXPECT_GT(pressed, 50);
  EXPECT_GT(both, 5);
}

}  // namespace
}  // namespace haptic_cloth::folded_mesh_test
