/// AMRC that starts with the coarsest mesh.
/// Criteria: flat cloth without strain has nothing to split, so its mesh stays the coarsest except
/// for leaves that pins require. Draped, it comes to rest where AMRC from the finest mesh does,
/// within AMRC's own error. For a curvature κ, refinement stops at the largest leaf with κl below
/// `refine_above`, coarsening at the largest with κl below `coarsen_below`, half of that here. So
/// the cells of the two meshes differ by a factor of at most two, and the error of elements with
/// linear sides grows with the square of their length: a coarse start ends at most four times as
/// far from the rest position of the finest mesh as a fine start. The coarsest mesh itself must be
/// farther off, or this would prove nothing. A board does not drape: however coarse its mesh was
/// before it met an obstacle, it ends where the finest mesh does, within half of the finest
/// spacing. (Two converged solves of the finest mesh at 1 and 0.5 ms end up to 0.6 spacings apart
/// in such drapes.) A cell that is compressed splits at twice the sum of the Euler load of
/// its length and a tenth of its weight (docs/decisions/0031), so a sheet that stands on its corners as one
/// cell folds down like the finest mesh, with the bound for a coarse start above. (The finest mesh itself
/// moves by 0.2 mm there with half the step.) A drape of suiting from the finest mesh has the corner folds of
/// the finest mesh: it ends nearer to that than the finest mesh with half the step does. Without that rule
/// for cells of levels 1 and 2 it ended 2.5 times as far.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::start_test {
namespace {

/// Flat free cloth with 16 × 8 coarsest cells of 8 × 8 finest ones, without load.
Scene flatCloth(Strategy strategy) {
  Scene scene = sheetScene(makeFabric({}), 129, 65, 0.256, 0.128);
  setStrategy(scene, strategy, 3);
  scene.gravity = Vec3::Zero();
  if (strategy == Strategy::Amrc) scene.adapt.start = StartMesh::Coarsest;
  return scene;
}

TEST(Start, FlatClothIsTheCoarsestMesh) {
  Simulation simulation(flatCloth(Strategy::Amrc));
  EXPECT_EQ(simulation.activeParticles(), 17 * 9);
  for (int step = 0; step < 40; ++step) EXPECT_EQ(simulation.step().refined, 0);
  EXPECT_EQ(simulation.activeParticles(), 17 * 9);
}

/// A pinned particle is a corner of all leaves that it touches. At the middle of a side of two
/// coarsest cells it makes them split once, and no other cell.
TEST(Start, PinsHaveLeavesSplit) {
  Scene scene = flatCloth(Strategy::Amrc);
  pin(scene, 0, 0, 0, 0);
  EXPECT_EQ(Simulation(scene).activeParticles(), 17 * 9);
  pin(scene, 44, 44, 32, 32);
  Simulation simulation(scene);
  std::vector<CellView> cells;
  simulation.cells(cells);
  EXPECT_EQ(cells.size(), 16U * 8 + 2 * 3);
  std::vector<char> active;
  simulation.activeFlags(active);
  EXPECT_TRUE(active[32 * 129 + 44]);
  // The middles of those two cells, plus the pinned particle, which is a corner of all leaves. The
  // middles of the other sides hang.
  EXPECT_EQ(simulation.activeParticles(), 17 * 9 + 2 + 1);
}

Scene drape(Strategy strategy, StartMesh start) {
  Scene scene = boxDrape(49);
  quasiStatic(scene, 10.0, 4e-3, 0.02);
  setStrategy(scene, strategy, 3);
  scene.adapt.start = start;
  return scene;
}

/// Positions of suiting that has draped over a box for 0.8 s.
std::vector<Vec3> folds(Strategy strategy, double time_step) {
  Scene scene = boxDrape(41);
  scene.cloth.fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml");
  setStrategy(scene, strategy, 2);
  scene.solver.time_step = time_step;
  Simulation simulation(scene);
  while (simulation.time() < 0.8 - 0.5 * time_step) simulation.step();
  std::vector<Vec3> positions;
  simulation.positions(positions);
  return positions;
}

struct Rest {
  std::vector<Vec3> positions;
  int first = 0, least = 0, most = 0;  ///< active particles in the first step, and the extremes
  double changed = 0.0;                ///< time of the last change of the mesh [s]
};

Rest rest(const Scene& scene) {
  Simulation simulation(scene);
  Rest rest;
  while (simulation.time() < 2.0) {
    const StepReport report = simulation.step();
    const int active = report.active_particles;
    if (report.refined + report.coarsened > 0) rest.changed = report.time;
    if (rest.first == 0) rest.first = rest.least = active;
    rest.least = std::min(rest.least, active);
    rest.most = std::max(rest.most, active);
  }
  simulation.positions(rest.positions);
  return rest;
}

/// Rms distance of positions [m].
double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (std::size_t p = 0; p < a.size(); ++p) sum += (a[p] - b[p]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

double distance(const Rest& a, const Rest& b) { return distance(a.positions, b.positions); }

TEST(Start, DrapeComesToTheSameRest) {
  const Rest finest = rest(drape(Strategy::Finest, StartMesh::Finest)),
             coarsest = rest(drape(Strategy::Coarsest, StartMesh::Finest)),
             from_below = rest(drape(Strategy::Amrc, StartMesh::Finest)),
             from_above = rest(drape(Strategy::Amrc, StartMesh::Coarsest));
  const double below = distance(from_below, finest), above = distance(from_above, finest);
  EXPECT_LT(from_above.first, 10 * 10);  // 7 × 7, and cells near the edges of the box
  EXPECT_LT(from_above.most, finest.first);
  EXPECT_LT(above, tolerance(4.0) * below);
  EXPECT_GT(distance(coarsest, finest), 4.0 * below);
}

/// Sheet of suiting that is dropped onto a box and finally hangs down its sides.
struct Board {
  std::string label;
  int particles, levels;
  double size, drop;  ///< [m]
  StartMesh start;
  int coarsest;  ///< upper bound for the smallest number of particles on the way
};

class BoardOnABox : public testing::TestWithParam<Board> {};

TEST_P(BoardOnABox, BecomesADrape) {
  const Board& board = GetParam();
  Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"),
                           board.particles, board.particles, board.size, board.size);
  setStrategy(scene, Strategy::Finest, board.levels);
  scene.air_damping = 0.5;
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3::Constant(0.08);
  box.pose.position.z() = -0.04 - board.drop;
  scene.obstacles = {box};
  const Rest finest = rest(scene);
  setStrategy(scene, Strategy::Amrc, board.levels);
  scene.adapt.start = board.start;
  const Rest amrc = rest(scene);
  EXPECT_LE(amrc.least, board.coarsest);
  EXPECT_LT(distance(amrc, finest), tolerance(0.5) * board.size / (board.particles - 1));
}

INSTANTIATE_TEST_SUITE_P(
    Meshes, BoardOnABox,
    testing::Values(Board{"merged_in_free_flight", 33, 5, 0.2, 0.15, StartMesh::Finest, 9},
                    Board{"merged_to_4_cells", 33, 5, 0.2, 0.05, StartMesh::Finest, 25},
                    Board{"one_cell_of_3_x_3", 3, 1, 0.3, 0.04, StartMesh::Coarsest, 9},
                    Board{"starts_as_one_cell", 65, 6, 0.2, 0.04, StartMesh::Coarsest, 9}),
    [](const auto& info) { return info.param.label; });

/// One cell without gravity, compressed along warp between its pinned corners.
/// @param load compression over the Euler load plus a tenth of the cell's standard weight [-]
int splitsOfOneCell(int level, double load) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  const int last = 1 << level;
  Scene scene = sheetScene(makeFabric(linear), last + 1, last + 1, 0.1, 0.05);
  setStrategy(scene, Strategy::Amrc, level);
  scene.adapt.start = StartMesh::Coarsest;
  scene.gravity = Vec3::Zero();
  const double length = scene.cloth.size[kWarp];
  const double limit = EIGEN_PI * EIGEN_PI * linear.rigidity / (length * length) +
                       0.1 * linear.areal_density * 9.80665 * length;
  const double tension = -load * limit, slope = linear.stiffness;
  scene.cloth.fabric.tensile[kWarp] = Curve(-1.0, 1.0, {tension - slope, tension, tension + slope});
  for (const int i : {0, last}) {
    for (const int j : {0, last}) pin(scene, i, i, j, j);
  }
  return Simulation(scene).step().refined;
}

TEST(Start, CompressedCellSplitsAboveTheEulerLoad) {
  for (const int level : {1, 2, 3}) {
    EXPECT_EQ(splitsOfOneCell(level, 1.999), 0) << level;
    EXPECT_EQ(splitsOfOneCell(level, 2.001), 1) << level;
  }
}

TEST(Start, CornerFoldsAreTheFinestMeshs) {
  const double h = SolverOptions().time_step;
  const std::vector<Vec3> finest = folds(Strategy::Finest, h);
  EXPECT_LT(distance(folds(Strategy::Amrc, h), finest),
            tolerance(1.0) * distance(folds(Strategy::Finest, 0.5 * h), finest));
}

/// Sheet with weft upwards on two of its corners, held at a third, and gravity tilted by 0.08.
Scene standing(Strategy strategy, int levels, StartMesh start) {
  constexpr int kLast = 32;
  Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"),
                           kLast + 1, kLast + 1, 0.2, 0.2);
  setStrategy(scene, strategy, levels);
  scene.adapt.start = start;
  scene.cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitX()));
  scene.gravity = Vec3(0.0, 0.8, -9.8);
  pin(scene, 0, 0, 0, 0);
  pin(scene, kLast, kLast, 0, 0);
  pin(scene, kLast, kLast, kLast, kLast);
  scene.air_damping = 5.0;
  scene.solver.time_step = 2e-3;
  scene.solver.minimizer.tolerance = 0.02;
  scene.solver.minimizer.max_iterations = 1000;
  return scene;
}

TEST(Start, StandingBoardFolds) {
  const Rest finest = rest(standing(Strategy::Finest, 2, StartMesh::Finest)),
             from_below = rest(standing(Strategy::Amrc, 2, StartMesh::Finest));
  const double below = distance(from_below, finest);
  for (const int levels : {4, 5}) {
    const Rest board = rest(standing(Strategy::Coarsest, levels, StartMesh::Finest)),
               folded = rest(standing(Strategy::Amrc, levels, StartMesh::Coarsest));
    EXPECT_LE(folded.first, 9) << levels;
    EXPECT_LT(folded.changed, 1.8) << levels;  // the mesh rests, too
    EXPECT_LT(distance(folded, finest), tolerance(4.0) * below) << levels;
    EXPECT_GT(distance(board, finest), 8.0 * below) << levels;
  }
}

}  // namespace
}  // namespace haptic_cloth::start_test
