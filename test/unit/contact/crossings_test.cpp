/// Check for crossings of the surface with itself.
/// Criteria: hand-made cases by the points where lines cut planes; random crumpled meshes of mixed
/// levels by exact intersections of all pairs (CGAL), which leave no tolerance.
#include "contact/crossings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <set>

#include "support/exact_geometry.h"

namespace haptic_cloth::crossings_test {
namespace {

/// Flat cloth of unit cells. The functions below place its particles.
struct Sheet {
  Sheet(const Grid& grid, const LeafMesh& leaves) : mesh(leaves, 1.0) {
    for (int p = 0; p < grid.particles(); ++p) x.emplace_back(grid.column(p), grid.row(p), 0.0);
  }
  Sheet(int columns, int rows)
      : Sheet({columns, rows, 0, 1.0, 1.0}, LeafMesh({columns, rows, 0, 1.0, 1.0}, {}, 0)) {}

  /// Positions of the nodes; hanging nodes lie between their masters.
  Field nodes() const {
    Field nodes;
    nodes.resize(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) nodes.set(n, x[mesh.particle[n]]);
    mesh.interpolateGhosts(nodes);
    return nodes;
  }
  Crossings crossings() const { return findCrossings(mesh, nodes()); }

  ActiveMesh mesh;
  std::vector<Vec3> x;  ///< of all particles [m]
};

/// Strip of four cells that turns back over its first cell, and whose last cell stands upright at
/// x = 0.4 and y from 0.25 to 0.75.
/// @param end height of its last column [m]
Sheet strip(double end) {
  Sheet sheet(5, 2);
  const std::array<Vec3, 5> columns{
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1.5, 0, 1), Vec3(0.4, 0, 1), Vec3(0.4, 0, end)}};
  for (int i = 0; i < 5; ++i) {
    for (const int j : {0, 1}) {
      Vec3 x = columns[i];
      x.y() = i < 3 ? j : 0.25 + 0.5 * j;
      sheet.x[sheet.mesh.grid.particle(i, j)] = x;
    }
  }
  return sheet;
}

TEST(Crossings, FlatClothHasNone) {
  Sheet sheet(9, 9);
  EXPECT_EQ(sheet.crossings().pairs, 0);
  const Quat turned = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  for (Vec3& x : sheet.x) x = turned * x;
  EXPECT_EQ(sheet.crossings().pairs, 0);
}

TEST(Crossings, NeighboursAreLeftOut) {
  Sheet sheet(9, 9);
  for (Vec3& x : sheet.x) x.z() = 5.0 * std::abs(x.x() - 4.0);  // two walls that share a row
  EXPECT_EQ(sheet.crossings().pairs, 0);
}

/// The upright cell cuts the first one along x = 0.4, z = 0. Its two sides and its diagonal cut a
/// triangle of the first cell each, at y = 0.25, 0.75 and 0.5. The diagonal of the first cell cuts a
/// triangle of the upright one at y = 0.4; its sides pass beside it.
TEST(Crossings, OfAStripAreCounted) {
  EXPECT_EQ(strip(0.5).crossings().pairs, 0);
  const Crossings found = strip(-1.0).crossings();
  EXPECT_EQ(found.pairs, 4);
  EXPECT_EQ(found.cell, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(found.other, (std::array<int, 2>{3, 0}));
  EXPECT_NEAR(found.position.x(), 0.4, 1e-15);
  EXPECT_NEAR(found.position.z(), 0.0, 1e-15);
}

/// At height 0 the lower ends of the two sides, and the side between them that touches both
/// triangles, lie in the first cell, whose diagonal touches that side in turn.
TEST(Crossings, TouchingCounts) {
  EXPECT_GT(strip(0.0).crossings().pairs, 0);
  EXPECT_EQ(strip(1e-300).crossings().pairs, 0);
}

/// Positions far from the origin leave few digits between the parts.
TEST(Crossings, SignsAreExactFarFromTheOrigin) {
  for (const double end : {std::ldexp(1.0, -33), -std::ldexp(1.0, -33)}) {  // a digit of 1e6 is 2^-33
    Sheet sheet = strip(end);
    for (Vec3& x : sheet.x) x += Vec3(1e6, 1e6, 1e6);
    EXPECT_EQ(sheet.crossings().pairs > 0, end < 0.0);
  }
}

TEST(Crossings, OfNodesThatAreNotFiniteAreLeftOut) {
  Sheet sheet = strip(-1.0);
  for (const int p : {4, 9}) sheet.x[p] = Vec3::Constant(NAN);
  EXPECT_EQ(sheet.crossings().pairs, 0);
}

// ---- comparison of random meshes ----

using Corners = std::array<int, 3>;  // nodes

/// Node in the middle of two on a thread; -1: none.
int middle(const ActiveMesh& mesh, int a, int b) {
  const Grid& grid = mesh.grid;
  const int i = grid.column(mesh.particle[a]) + grid.column(mesh.particle[b]),
            j = grid.row(mesh.particle[a]) + grid.row(mesh.particle[b]);
  return i % 2 == 0 && j % 2 == 0 ? mesh.node[grid.particle(i / 2, j / 2)] : -1;
}

/// The two triangles of a leaf, each from the corner across the diagonal: a cell is cut as on a
/// union jack.
std::array<Corners, 2> halves(const Patch& patch) {
  const auto& n = patch.nodes;
  const int span = patch.cell.span();
  const bool rises = (patch.cell.i / span + patch.cell.j / span) % 2 == 0;
  return rises ? std::array<Corners, 2>{{{n[1], n[3], n[0]}, {n[2], n[0], n[3]}}}
               : std::array<Corners, 2>{{{n[0], n[1], n[2]}, {n[3], n[2], n[1]}}};
}

/// Triangles of a conforming mesh of the same surface: halves of leaves, divided at hanging nodes.
std::vector<Corners> conforming(const ActiveMesh& mesh) {
  std::vector<Corners> triangles;
  for (const Patch& patch : mesh.patches) {
    for (const auto& [corner, first, last] : halves(patch)) {
      const int one = middle(mesh, first, corner), other = middle(mesh, corner, last);
      const int apex = one >= 0 ? one : other >= 0 ? other : corner;
      std::vector<int> border;
      for (const int node : {first, one, corner, other, last}) {
        if (node >= 0) border.push_back(node);
      }
      std::rotate(border.begin(), std::find(border.begin(), border.end(), apex), border.end());
      for (std::size_t k = 1; k + 1 < border.size(); ++k)
        triangles.push_back({apex, border[k], border[k + 1]});
    }
  }
  return triangles;
}

/// Sides of leaves, halved at hanging nodes, and diagonals; each once.
std::set<std::pair<int, int>> edgesOf(const ActiveMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const Patch& patch : mesh.patches) {
    for (const Corners& half : halves(patch)) {
      edges.insert(std::minmax(half[1], half[2]));
      for (const int end : {half[1], half[2]}) {
        const int hanging = middle(mesh, half[0], end);
        edges.insert(std::minmax(half[0], hanging < 0 ? end : hanging));
        if (hanging >= 0) edges.insert(std::minmax(hanging, end));
      }
    }
  }
  return edges;
}

class Truth {
 public:
  Truth(const ActiveMesh& mesh, const Field& nodes) : mesh_(mesh), nodes_(nodes) {}

  /// Number of pairs as findCrossings() defines them, among all edges and triangles.
  int pairs() const {
    int count = 0;
    for (const Patch& patch : mesh_.patches) {
      for (const Corners& t : halves(patch)) {
        if (isCollapsed(place(t))) continue;
        const Triangle at_rest{atRest(t[0]), atRest(t[1]), atRest(t[2])};
        for (const auto& [a, b] : edgesOf(mesh_)) {
          if (doIntersect(Segment{atRest(a), atRest(b)}, at_rest)) continue;
          count += doIntersect(Segment{nodes_[a], nodes_[b]}, place(t)) ? 1 : 0;
        }
      }
    }
    return count;
  }

  /// Tells whether the conforming mesh intersects itself: two triangles that share no node, or one
  /// node and then the side across it with the other triangle.
  bool intersectsItself() const {
    const std::vector<Corners> triangles = conforming(mesh_);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        if (intersect(triangles[k], triangles[l])) return true;
      }
    }
    return false;
  }

 private:
  bool intersect(const Corners& a, const Corners& b) const {
    std::vector<int> common;
    for (const int node : a) {
      if (std::count(b.begin(), b.end(), node) > 0) common.push_back(node);
    }
    if (common.size() > 1) return false;
    if (common.empty()) return doIntersect(place(a), place(b));
    return doIntersect(across(a, common[0]), place(b)) || doIntersect(across(b, common[0]), place(a));
  }
  Segment across(const Corners& t, int node) const {
    const auto k = static_cast<std::size_t>(std::find(t.begin(), t.end(), node) - t.begin());
    return {nodes_[t[(k + 1) % 3]], nodes_[t[(k + 2) % 3]]};
  }
  Vec3 atRest(int node) const {
    const int p = mesh_.particle[node];
    return {double(mesh_.grid.column(p)), double(mesh_.grid.row(p)), 0.0};
  }
  Triangle place(const Corners& t) const { return {nodes_[t[0]], nodes_[t[1]], nodes_[t[2]]}; }

  const ActiveMesh& mesh_;
  const Field& nodes_;
};

/// Mesh of three levels after random splits and merges.
LeafMesh randomLeaves(const Grid& grid, std::mt19937& random) {
  LeafMesh leaves(grid, {}, 2);
  std::vector<Cell> split;
  for (int k = 0; k < 12; ++k)
    leaves.split(leaves.leafAt(static_cast<int>(random() % (grid.columns - 1)),
                               static_cast<int>(random() % (grid.rows - 1))),
                 split);
  return leaves;
}

/// Waves of random direction and phase on a sheet that is drawn together.
/// @param lattice distance of the values of a coordinate: hanging nodes are exact, and with a coarse
/// one many parts touch or coincide
void crumple(Sheet& sheet, double amplitude, double lattice, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<Vec3> moved = sheet.x;
  for (int wave = 0; wave < 6; ++wave) {
    const Vec3 along(number(random), number(random), 0.0),
        push(number(random), number(random), number(random));
    const double phase = 3.0 * number(random);
    for (std::size_t p = 0; p < moved.size(); ++p)
      moved[p] += amplitude * std::sin(along.dot(sheet.x[p]) + phase) * push;
  }
  for (std::size_t p = 0; p < moved.size(); ++p) {
    for (int k = 0; k < 3; ++k) sheet.x[p][k] = lattice * std::round(moved[p][k] / lattice);
  }
}

struct Crumpled {
  const char* name;
  double amplitude, lattice;
  int count, least_crossed;  ///< meshes, and of these at least so many cross themselves
};

class CrumpledMesh : public testing::TestWithParam<Crumpled> {};

TEST_P(CrumpledMesh, IsJudgedAsByExactIntersections) {
  std::mt19937 random(5);
  const Grid grid{13, 13, 2, 1.0, 1.0};
  int crossed = 0, pairs = 0;
  for (int k = 0; k < GetParam().count; ++k) {
    Sheet sheet(grid, randomLeaves(grid, random));
    ASSERT_FALSE(sheet.mesh.ghosts.empty());
    crumple(sheet, GetParam().amplitude, GetParam().lattice, random);
    const Field nodes = sheet.nodes();
    const Truth truth(sheet.mesh, nodes);
    const int found = findCrossings(sheet.mesh, nodes).pairs;
    EXPECT_EQ(found, truth.pairs()) << k;
    if (GetParam().lattice < 1e-3) {
      EXPECT_EQ(found > 0, truth.intersectsItself()) << k;
    }
    crossed += found > 0 ? 1 : 0;
    pairs += found;
  }
  std::cout << "  " << crossed << " of " << GetParam().count << " cross themselves, " << pairs << " pairs\n";
  EXPECT_GE(crossed, GetParam().least_crossed);
  EXPECT_LT(crossed, GetParam().count + (GetParam().amplitude > 1.0 ? 1 : 0));  // some do not
}

// On a lattice of 2^-20 parts touch by chance once in a million; on one of 1/2 everywhere.
INSTANTIATE_TEST_SUITE_P(Random, CrumpledMesh,
                         testing::Values(Crumpled{"slightly", 0.7, std::ldexp(1.0, -20), 40, 5},
                                         Crumpled{"strongly", 2.0, std::ldexp(1.0, -20), 10, 10},
                                         Crumpled{"touching", 1.5, 0.5, 20, 10}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace haptic_cloth::crossings_test
