/// Pairs on a straight way. Criterion: distances at 20,001 places on the way.
#include "contact/pair_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace haptic_cloth {
namespace {

/// A pair on a straight way.
struct Way {
  std::array<int, 4> nodes{0, 1, 2, 3};
  Field from, to;
  bool lines;

  double distanceAt(double share) const {
    std::array<Vec3, 4> x;
    for (int c = 0; c < 4; ++c) x[c] = (1.0 - share) * from[c] + share * to[c];
    return (lines ? betweenLines(x[0], x[1], x[2], x[3]) : fromTriangle(x[0], x[1], x[2], x[3])).norm();
  }
  double smallestDistance() const {
    constexpr int kPlaces = 20000;
    double least = distanceAt(1.0);
    for (int k = 0; k < kPlaces; ++k) least = std::min(least, distanceAt(double(k) / kPlaces));
    return least;
  }
  bool staysApart() const { return staysApartOnWay(nodes, lines, from, to); }
};

Way wayOf(bool lines, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Way way;
  way.from = Field(from);
  way.to = Field(to);
  way.lines = lines;
  return way;
}

/// Corners within a cube of 1 m around the origin at both ends of the way.
Way randomWay(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::vector<Vec3> ends[2];
  for (auto& end : ends) {
    for (int c = 0; c < 4; ++c) end.emplace_back(place(random), place(random), place(random));
  }
  return wayOf(seed % 2 == 0, ends[0], ends[1]);
}

/// A distance changes by at most 2 · 1.7 m on the way, so by 1e-4 m from one place to the middle to the next.
TEST(PairOnWay, MeetsWhereTheDistanceVanishes) {
  int apart = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Way way = randomWay(seed);
    const double least = way.smallestDistance();
    if (least > 1e-4) {
      ++apart;
      EXPECT_TRUE(way.staysApart()) << "seed " << seed << ", " << least << " m";
    }
    // The first part is moved so that both meet in the middle of the way.
    std::array<Vec3, 4> x;
    for (int c = 0; c < 4; ++c) x[c] = 0.5 * (way.from[c] + way.to[c]);
    const Vec3 between =
        way.lines ? betweenLines(x[0], x[1], x[2], x[3]) : fromTriangle(x[0], x[1], x[2], x[3]);
    for (int c = 0; c < (way.lines ? 2 : 1); ++c) {
      way.from.add(c, -between);
      way.to.add(c, -between);
    }
    EXPECT_FALSE(way.staysApart()) << "seed " << seed;
  }
  EXPECT_GT(apart, 200);
}

TEST(PairOnWay, GoesAroundABorder) {
  const std::vector<Vec3> triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto nodeGoes = [&](const Vec3& from, const Vec3& to) {
    std::vector<Vec3> start{from}, end{to};
    for (auto* list : {&start, &end}) list->insert(list->end(), triangle.begin(), triangle.end());
    return wayOf(false, start, end).staysApart();
  };
  EXPECT_TRUE(nodeGoes({0.2, -0.01, 0.1}, {0.2, -0.01, -0.1}));   // beside it
  EXPECT_TRUE(nodeGoes({-0.5, 0.2, 0.3}, {0.3, -0.5, -0.3}));     // around the corner
  EXPECT_FALSE(nodeGoes({0.2, 0.2, 0.1}, {0.2, 0.2, -0.1}));      // through it
  EXPECT_FALSE(nodeGoes({0.2, 0.2, 1e-6}, {0.2, 0.2, -1e-6}));    // through it, from nearby
  EXPECT_FALSE(nodeGoes({0.2, -1e-9, 0.1}, {0.2, -1e-9, -0.1}));  // so near that rounding decides
  EXPECT_TRUE(nodeGoes({0.2, 0.2, 0.1}, {0.2, 0.2, 1e-5}));       // up to it
}

}  // namespace
}  // namespace haptic_cloth
