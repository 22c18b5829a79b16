/// Mirror symmetry of the mesh. Criterion: a scene and its mirror image have the same leaves after
/// every step, whichever side is processed first. Nothing loads the cloth, so no number is near a
/// threshold and rounding decides nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "support/scenes.h"

namespace haptic_cloth {
namespace {

constexpr int kColumns = 33, kRows = 17;

using Leaves = std::set<std::array<int, 3>>;  ///< column and row of the lower left corner, level

/// @param sides -1 along x or y if that coordinate is mirrored, else 1
Leaves leaves(const Simulation& simulation, const std::array<int, 2>& sides) {
  std::vector<CellView> cells;
  simulation.cells(cells);
  Leaves leaves;
  for (const CellView& cell : cells) {
    const int span = 1 << cell.level, i = cell.particles[0] % kColumns, j = cell.particles[0] / kColumns;
    leaves.insert(
        {sides[0] > 0 ? i : kColumns - 1 - i - span, sides[1] > 0 ? j : kRows - 1 - j - span, cell.level});
  }
  return leaves;
}

class Mirrored : public testing::TestWithParam<std::array<int, 2>> {};

TEST_P(Mirrored, MeshesMergeAlike) {
  // Cells near the probe are finest. After its removal they merge level by level, beside coarser
  // ones that may only merge after them.
  const std::array<int, 2> sides = GetParam();
  Scene scene = sheetScene(makeFabric({}), kColumns, kRows, 0.16, 0.08);
  setStrategy(scene, Strategy::Amrc, 3);
  scene.adapt.start = StartMesh::Coarsest;
  scene.adapt.interval = 1;
  scene.adapt.minimum_age = 1;
  scene.gravity = Vec3::Zero();
  Simulation plain(scene), mirrored(scene);
  int least = kColumns * kRows, most = 0;
  for (int step = 0; step < 60; ++step) {
    const Vec3 device(-0.07 + 0.002 * step, 0.03 - 0.001 * step, 0.015);
    if (step == 40) {
      plain.removeDevice();
      mirrored.removeDevice();
    } else if (step < 40) {
      plain.setDevice(device, Vec3::Zero());
      mirrored.setDevice(Vec3(sides[0] * device.x(), sides[1] * device.y(), device.z()), Vec3::Zero());
    }
    most = std::max(most, plain.step().active_particles);
    mirrored.step();
    least = plain.activeParticles();
    ASSERT_EQ(leaves(plain, {1, 1}), leaves(mirrored, sides)) << "after step " << step;
  }
  EXPECT_GT(most, 100);
  EXPECT_EQ(least, 5 * 3);
}

INSTANTIATE_TEST_SUITE_P(Axes, Mirrored,
                         testing::Values(std::array<int, 2>{-1, 1}, std::array<int, 2>{1, -1},
                                         std::array<int, 2>{-1, -1}));

}  // namespace
}  // namespace haptic_cloth
