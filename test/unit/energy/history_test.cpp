// Memory of the fabric through changes of the mesh.
// Criteria: total forces of [M04] 3.3. Splitting a cell and merging four keep the total tension
// across it in both directions and the total shear force, to round-off. An even state stays even.
// Forces that the loop allows are restored exactly.
#include "energy/history.h"

#include <gtest/gtest.h>

#include "energy/internal_energy.h"
#include "support/derivatives.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::history_test {
namespace {

const Grid kGrid{9, 9, 2, 0.01, 0.01};
const Cell kParent{0, 0, 1};
const std::array<Cell, 4> kChildren{Cell{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};

/// Sum of tension times half width over the two sides of a cell along one direction.
double total(ForceHistory& history, const Cell& cell, Direction direction) {
  const auto& s = history.sides(cell);
  return 0.5 * cell.span() * (direction == kWarp ? s[0] + s[1] : s[2] + s[3]);
}

TEST(ForceHistory, SplittingAndMergingKeepTotalForces) {
  ForceHistory history(kGrid);
  const Eigen::VectorXd values = fixedRandom(40, 9);
  for (int k = 0; k < 4; ++k) {
    for (int side = 0; side < 4; ++side) history.sides(kChildren[k])[side] = values[4 * k + side];
    history.shear(kChildren[k]) = values[20 + k];
  }
  // A warp thread crosses two columns of cells, so its total is the mean over both.
  const auto fine = [&](Direction d) {
    double sum = 0.0;
    for (const Cell& cell : kChildren) sum += total(history, cell, d);
    return 0.5 * sum;
  };
  const double warp = fine(kWarp), weft = fine(kWeft);
  const double shear = 0.25 * (values[20] + values[21] + values[22] + values[23]);
  history.merge(kParent);
  EXPECT_NEAR(total(history, kParent, kWarp), warp, tolerance(1e-15));
  EXPECT_NEAR(total(history, kParent, kWeft), weft, tolerance(1e-15));
  EXPECT_NEAR(history.shear(kParent), shear, tolerance(1e-15));
  history.split(kParent);
  EXPECT_NEAR(fine(kWarp), warp, tolerance(1e-15));
  EXPECT_NEAR(fine(kWeft), weft, tolerance(1e-15));
  for (const Cell& cell : kChildren) EXPECT_NEAR(history.shear(cell), shear, tolerance(1e-15));
}

TEST(ForceHistory, EqualMomentsStayEqual) {
  ForceHistory history(kGrid);
  for (int p = 0; p < kGrid.particles(); ++p) history.moment(p, kWarp) = 3.0;
  history.merge(kParent);
  history.split(kParent);
  for (int p = 0; p < kGrid.particles(); ++p) EXPECT_NEAR(history.moment(p, kWarp), 3.0, tolerance(1e-14));
}

TEST(ForceHistory, ElementsRecallWhatTheyRemembered) {
  // A fabric with loops is deformed at random and back, so its forces depend on its history, not
  // only on its shape. Recorded and read on the same mesh, they must be equal.
  Fabric fabric = makeFabric({});
  fabric.tensile[kWarp] = Loop(-0.05, 0.05, {-50.0, 0.0, 60.0}, {-50.0, 0.0, 40.0}, 3.0);
  fabric.bending = {Loop(-256.0, 256.0, {-2e-3, 5e-4, 3e-3}, {-3e-3, -5e-4, 2e-3}, 30.0),
                    Loop(Curve::linear(1e-5))};
  fabric.shear = Loop(-0.1, 0.1, {-2.0, 1.0, 4.0}, {-4.0, -1.0, 2.0}, 30.0);
  LeafMesh leaves(kGrid, {}, 2);
  std::vector<Cell> done;
  leaves.split(leaves.leafAt(5, 2), done);
  ActiveMesh mesh(leaves, 0.2);
  InternalEnergy internal(fabric, mesh);
  ForceHistory history(kGrid);
  ASSERT_TRUE(internal.hasMemory());
  std::vector<Vec3> positions;
  for (const int p : mesh.particle) positions.emplace_back(kGrid.column(p) * 0.01, kGrid.row(p) * 0.01, 0.0);
  const Field flat(positions);
  Field x;
  const auto gradient = [&] {
    internal.evaluate(0, internal.size(), x);
    Field g;
    g.clear(mesh.nodes());
    internal.addGradient(0, mesh.nodes(), g);
    return g;
  };
  internal.setNormals(flat);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd noise = 5e-4 * fixedRandom(3 * mesh.nodes(), seed);
    x = flat;
    for (int n = 0; n < mesh.nodes(); ++n) x.add(n, noise.segment<3>(3 * n));
    internal.commit(0, internal.size(), x);
  }
  const Field before = gradient();
  ASSERT_GT(mesh.ghosts.size(), 0u);
  for (const Ghost& ghost : mesh.ghosts)
    history.moment(mesh.particle[ghost.node], kWarp) = 1e9;  // left over from earlier
  internal.remember(x, history);
  for (const Ghost& ghost : mesh.ghosts) {
    const auto moment = [&](int node) { return history.moment(mesh.particle[node], kWarp); };
    EXPECT_DOUBLE_EQ(moment(ghost.node), 0.5 * (moment(ghost.a) + moment(ghost.b)));
  }
  internal.resize();
  internal.recall(x, history);
  const Field after = gradient();
  double scale = 0.0, worst = 0.0;
  for (int n = 0; n < mesh.nodes(); ++n) {
    scale = std::max(scale, before[n].norm());
    worst = std::max(worst, (after[n] - before[n]).norm());
  }
  EXPECT_GT(scale, 1e-3);
  EXPECT_LT(worst, tolerance(1e-9) * scale);
}

TEST(ForceHistory, FreeBordersHaveNoMomentLeftFromEarlierMerges) {
  const Grid grid{5, 5, 2, 0.01, 0.01};
  const LeafMesh leaves(grid, {}, 0);
  const ActiveMesh mesh(leaves, 0.15);
  const Fabric fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml");
  InternalEnergy internal(fabric, mesh);
  Field x;
  x.clear(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) x.set(n, Vec3(0.01 * (n % 5), 0.01 * (n / 5), 0.0));
  internal.setNormals(x);
  ForceHistory history(grid);
  history.moment(grid.particle(1, 0), kWarp) = 1e-3;
  history.merge({0, 0, 1});
  const int corner = grid.particle(0, 0);
  ASSERT_GT(history.moment(corner, kWarp), 0.0);
  internal.remember(x, history);
  for (const Direction direction : {kWarp, kWeft}) {
    EXPECT_EQ(history.moment(corner, direction), 0.0);
    EXPECT_EQ(history.curvature(corner, direction), 0.0);
  }
}

}  // namespace
}  // namespace haptic_cloth::history_test
