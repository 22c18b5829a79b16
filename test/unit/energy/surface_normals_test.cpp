/// Normals at the nodes of a folded sheet.
/// Criteria: by symmetry the normal at the crease lies in the plane that halves the fold, also where the
/// normals of the two sides cancel; round-off of some ten terms, 1e-12. Threads that turn by φ in the plane
/// of a flat sheet may tilt it by (φ/2)³, or twice that at a border, by the definition in docs/model.md.
#include "energy/surface_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerance.h"

namespace haptic_cloth::surface_normals_test {
namespace {

const Grid kGrid{17, 9, 1, 0.004, 0.005};
constexpr int kCrease = 8;  // column
constexpr double kFolded = EIGEN_PI;
const Quat kTurned(Eigen::AngleAxisd(0.9, Vec3(0.3, -0.5, 0.8).normalized()));

/// Nodes of a sheet that is turned in space. @param place of particle (i, j) before that [m]
template <class Place>
Field placed(const ActiveMesh& mesh, const Place& place) {
  Field x;
  x.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n)
    x.set(n, kTurned * place(kGrid.column(mesh.particle[n]), kGrid.row(mesh.particle[n])));
  return x;
}

/// Normal at a node before the sheet was turned.
Vec3 normalAt(const SurfaceNormals& normals, int node) { return kTurned.inverse() * normals.node(node); }

void expectTheCreaseIsHalved(const LeafMesh& leaves) {
  const ActiveMesh mesh(leaves, 0.15);
  SurfaceNormals normals(mesh, false);
  for (const double turn : {1e-3, 0.1, 1.0, 2.0, 3.0, kFolded - 1e-9, kFolded}) {
    // Flat sheets on both sides of the crease, of which each rises by half of the turn.
    const Vec3 along(std::cos(0.5 * turn), 0.0, 0.0), up(0.0, 0.0, std::sin(0.5 * turn));
    normals.update(mesh, placed(mesh, [&](int i, int j) {
                     const double u = (i - kCrease) * kGrid.dx;
                     return Vec3(u * along + std::abs(u) * up + Vec3(0.0, j * kGrid.dy, 0.0));
                   }));
    int creased = 0;
    for (int n = 0; n < mesh.active(); ++n) {
      if (kGrid.column(mesh.particle[n]) != kCrease) continue;
      ++creased;
      // Which side is up is undefined where the sides lie on each other.
      const double rises = normalAt(normals, n).z();
      EXPECT_NEAR(turn < kFolded ? rises : std::abs(rises), 1.0, tolerance(1e-12)) << "turn " << turn;
    }
    EXPECT_GE(creased, 5);
  }
}

TEST(SurfaceNormals, HalveAFoldBetweenEqualCells) { expectTheCreaseIsHalved(LeafMesh(kGrid, {}, 0)); }

TEST(SurfaceNormals, HalveAFoldBetweenCellsOfTwoSizes) {
  LeafMesh leaves(kGrid, {}, 1);
  std::vector<Cell> done;
  for (int i = kCrease; i < kGrid.columns - 1; i += 2) {
    for (int j = 0; j < kGrid.rows - 1; j += 2) leaves.split(leaves.leafAt(i, j), done);
  }
  expectTheCreaseIsHalved(leaves);
}

TEST(SurfaceNormals, HardlyTiltWhereThreadsTurnInThePlaneOfTheSheet) {
  // Warp threads on circles in the plane; they turn by φ per cell, and shear the cells by their angle.
  const ActiveMesh mesh(LeafMesh(kGrid, {}, 0), 0.15);
  const double turn = 0.1, radius = kGrid.dx / turn;
  const auto angleAt = [turn](int column) { return (column - kCrease) * turn; };
  SurfaceNormals normals(mesh, false);
  normals.update(mesh, placed(mesh, [&](int i, int j) {
                   return Vec3(radius * std::sin(angleAt(i)), j * kGrid.dy - radius * std::cos(angleAt(i)),
                               0.0);
                 }));
  for (int n = 0; n < mesh.active(); ++n) {
    const int row = kGrid.row(mesh.particle[n]);
    const bool border = row == 0 || row == kGrid.rows - 1;
    const double angle = std::abs(angleAt(kGrid.column(mesh.particle[n])));
    const double area = std::cos(angle + turn);  // of sheared cells, over that at rest
    const double most = std::pow(0.5 * turn, 3) / area * (border ? 2.0 : 1.0);
    EXPECT_LE(normalAt(normals, n).head<2>().norm(), tolerance(most));
  }
}

TEST(SurfaceNormals, StandOnASheetThatIsStretchedUnevenly) {
  // Strains along warp grow from 0 to 2, by 0.13 from cell to cell.
  const ActiveMesh mesh(LeafMesh(kGrid, {}, 0), 0.15);
  SurfaceNormals normals(mesh, false);
  normals.update(mesh, placed(mesh, [](double i, double j) {
                   return Vec3((i + i * i / (kGrid.columns - 1)) * kGrid.dx, j * kGrid.dy, 0.0);
                 }));
  for (int n = 0; n < mesh.active(); ++n) EXPECT_NEAR(normalAt(normals, n).z(), 1.0, tolerance(1e-12));
}

}  // namespace
}  // namespace haptic_cloth::surface_normals_test
