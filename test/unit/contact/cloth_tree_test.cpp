/// Which parts of the cloth may meet. Criteria: smooth parts keep at least half of their flat distance,
/// the others the margins of their boxes (contact/cloth_tree.h).
#include "contact/cloth_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

namespace haptic_cloth::cloth_tree_test {
namespace {

constexpr double kSpacing = 4e-3;  // [m]

Vec3 flat(const ActiveMesh& mesh, int n) {
  return {mesh.grid.column(mesh.particle[n]) * kSpacing, mesh.grid.row(mesh.particle[n]) * kSpacing, 0.0};
}

/// The pairs of patches that the tree cannot leave out, of cloth at rest.
std::set<std::pair<int, int>> nearPairs(const ActiveMesh& mesh, const Field& x, double margin) {
  Field still;
  still.clear(mesh.nodes());
  ClothTree tree(mesh.grid);
  tree.rebuild(mesh);
  tree.fit(mesh, x, still, std::vector<double>(mesh.nodes(), margin));
  std::set<std::pair<int, int>> pairs;
  tree.forNear(0.0, [&](int a, int b) { pairs.insert(std::minmax(a, b)); });
  return pairs;
}

/// A sheet over the edge of a box: the tangents across the edge lie at 45 degrees to their mean, so λ is
/// cos 45° = 0.71, above the 0.5 that count as smooth. Whichever of the axes the edge is parallel to.
TEST(ClothTree, SheetOverAnEdgeIsSmooth) {
  const Grid grid{17, 13, 2, kSpacing, kSpacing};
  const ActiveMesh mesh(LeafMesh(grid, {}, 0), 0.2);
  for (const int axis : {0, 1, 2}) {
    for (const bool weft : {false, true}) {
      SCOPED_TRACE(axis);
      Field x;
      x.resize(mesh.nodes());
      for (int n = 0; n < mesh.nodes(); ++n) {
        const Vec3 at = flat(mesh, n);
        const double across = at[weft ? 1 : 0] - 6.0 * kSpacing;
        Vec3 place;
        place[axis] = at[weft ? 0 : 1];
        place[(axis + 1) % 3] = std::min(across, 0.0);
        place[(axis + 2) % 3] = std::min(-across, 0.0);
        x.set(n, place);
      }
      EXPECT_EQ(nearPairs(mesh, x, 0.0).size(), 0U);
    }
  }
}

/// Crumpled sheets, from waves that hardly bend them to noise as long as a cell.
TEST(ClothTree, LeavesOutOnlyWhatStaysApart) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> normal;
  const Grid grid{14, 11, 2, kSpacing, kSpacing};
  constexpr double kMargin = 0.1 * kSpacing;
  int smooth = 0, rough = 0;
  for (int run = 0; run < 40; ++run) {
    LeafMesh leaves(grid, {}, 0);
    const ActiveMesh mesh(leaves, 0.2);
    const double size = kSpacing * std::pow(10.0, -2.0 + 2.0 * share(random)), turn = 8.0 * share(random);
    const Quat pose = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    Field x;
    x.resize(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) {
      const Vec3 at = flat(mesh, n);
      const double angle = turn * at.x() / (grid.columns * kSpacing), radius = grid.columns * kSpacing / turn;
      const Vec3 rolled(radius * std::sin(angle), at.y(), radius * (1.0 - std::cos(angle)));
      x.set(n, pose * rolled + size * Vec3(normal(random), normal(random), normal(random)));
    }
    const auto near = nearPairs(mesh, x, kMargin);
    const auto point = [&](const Patch& patch, double u, double v, const auto& valueOf) -> Vec3 {
      return (1.0 - v) * ((1.0 - u) * valueOf(patch.nodes[0]) + u * valueOf(patch.nodes[1])) +
             v * ((1.0 - u) * valueOf(patch.nodes[2]) + u * valueOf(patch.nodes[3]));
    };
    const auto inSpace = [&](int n) { return Vec3(x[n]); };
    const auto inCloth = [&](int n) { return flat(mesh, n); };
    const int patches = static_cast<int>(mesh.patches.size());
    for (int a = 0; a < patches; ++a) {
      for (int b = a; b < patches; ++b) {
        if (near.count({a, b}) != 0) {
          ++rough;
          continue;
        }
        ++smooth;
        for (int k = 0; k < 4; ++k) {
          const double u = share(random), v = share(random), s = share(random), t = share(random);
          const Patch &one = mesh.patches[a], &other = mesh.patches[b];
          const double distance = (point(one, u, v, inSpace) - point(other, s, t, inSpace)).norm();
          const double rest = (point(one, u, v, inCloth) - point(other, s, t, inCloth)).norm();
          EXPECT_GE(distance, std::min(0.5 * rest, 2.0 * kMargin) - 1e-6 * kSpacing);
        }
      }
    }
  }
  EXPECT_GT(smooth, 10000);
  EXPECT_GT(rough, 10000);
}

}  // namespace
}  // namespace haptic_cloth::cloth_tree_test
