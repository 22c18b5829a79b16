/// Pairs on a straight way. Criterion: distances at 20,001 places on the way.
#include "contact/pair_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace haptic_cloth::pair_geometry_test {
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

/// Parts of 2.5 mm that meet inside both of them. Where they begin near each other, rounding of the places,
/// 0.1 m from the origin, tilts the direction between them: it must not lead the walk past the meeting.
TEST(PairOnWay, MeetsHoweverNearItBegins) {
  constexpr double kLength = 2.5e-3;  // [m]
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int near = 0;
  for (int k = 0; k < 40000; ++k) {
    const bool lines = k % 2 == 0;
    const Vec3 u = kLength * vector().normalized(), v = kLength * vector().normalized();
    const double s = share(random), t = (lines ? 1.0 : 1.0 - s) * share(random);
    const Vec3 corner = -s * u - t * v;
    const std::vector<Vec3> at_meeting =
        lines ? std::vector<Vec3>{-s * u, (1.0 - s) * u, -t * v, (1.0 - t) * v}
              : std::vector<Vec3>{Vec3::Zero(), corner, corner + u, corner + v};
    const Vec3 place = 0.1 * vector();
    const double meeting = 0.1 + 0.8 * share(random), size = kLength * std::pow(10.0, -6.0 * share(random));
    std::vector<Vec3> from, to;
    for (const Vec3& at : at_meeting) {
      const Vec3 motion = size * vector();
      from.push_back(place + at - meeting * motion);
      to.push_back(place + at + (1.0 - meeting) * motion);
    }
    const Way way = wayOf(lines, from, to);
    near += way.distanceAt(0.0) < 1e-4 * kLength ? 1 : 0;
    EXPECT_FALSE(way.staysApart()) << (lines ? "lines" : "node and triangle") << ", begins at "
                                   << way.distanceAt(0.0) << " m";
  }
  EXPECT_GT(near, 10000);
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
}  // namespace haptic_cloth::pair_geometry_test
