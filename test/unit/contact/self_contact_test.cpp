/// Contact of the cloth with itself: which pairs are found, their forces, and steps that cross nothing.
/// Criteria: distances by plain search over all pairs; forces by differences of the energy; crossings by
/// the exact check (contact/crossings.h).
#include "contact/self_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <set>

#include "contact/crossings.h"
#include "contact/friction_law.h"
#include "haptic_cloth/simulation.h"
#include "state/archive.h"
#include "support/folded_cloth.h"
#include "support/scenes.h"

namespace haptic_cloth::self_contact_test {
namespace {

/// Adds a vector at all nodes of the upper layer of a hairpin that turns back at 40 mm [m].
void moveUpper(const Folded& cloth, Field& nodes, const Vec3& by) {
  for (int n = 0; n < cloth.mesh.nodes(); ++n) {
    if (cloth.flat(n).x() > 0.045) nodes.add(n, by);
  }
}

/// A rolled sheet turns by far more than half a turn; every pair of its layers that is near is found.
/// The layers lie 0.6 thicknesses apart, so nodes and triangles press across the whole roll.
TEST(SelfContact, FindsAllPairsOfNodesAndTriangles) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Grid grid = gridOf(41, 9, 2);
    Folded cloth(grid, mixedLeaves(grid, seed), 0.0);
    std::mt19937 random(seed);
    cloth.place([](const Vec3& at) { return hairpin(at, 0.07, 0.6 * kThickness + 0.02 * at.y()); });
    shake(cloth, random, 1e-5);
    cloth.collect();
    std::set<std::array<int, 4>> expected;
    for (std::size_t p = 0; p < cloth.mesh.patches.size(); ++p) {
      for (const int half : {0, 1}) {
        const auto& t = cloth.surface.triangle(static_cast<int>(p), half);
        // Only pairs far apart in the flat cloth: the range of others depends on how far.
        for (int n = 0; n < cloth.mesh.nodes(); ++n) {
          const Vec3 a = cloth.x[t[0]], b = cloth.x[t[1]], c = cloth.x[t[2]], p3 = cloth.x[n];
          const Vec3 middle = (cloth.flat(t[0]) + cloth.flat(t[1]) + cloth.flat(t[2])) / 3.0;
          if ((cloth.flat(n) - middle).norm() < 10.0 * kSpacing) continue;
          const Vec3 normal = (b - a).cross(c - a).normalized();
          const double height = normal.dot(p3 - a);
          const Vec3 foot = p3 - height * normal;
          const auto left = [&](const Vec3& from, const Vec3& to) {
            return normal.dot((to - from).cross(foot - from)) > 1e-9 * kSpacing * kSpacing;
          };
          const bool inside = left(a, b) && left(b, c) && left(c, a);
          if (inside && std::abs(height) < 0.99 * kThickness) expected.insert({n, t[0], t[1], t[2]});
        }
      }
    }
    ASSERT_GT(expected.size(), 10u);
    std::set<std::array<int, 4>> found;
    cloth.contact.forPairs([&](const PairPack& pack, int l) {
      if (!pack.lines) found.insert(nodesOf(pack, l));
    });
    for (const auto& pair : expected)
      EXPECT_TRUE(found.count(pair)) << "seed " << seed << " node " << pair[0];
  }
}

/// Distance of a point from a triangle by plain search, at most 5 % of a side too large [m].
double searchedDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr int kParts = 12;
  double least = 1e300;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; i + j <= kParts; ++j)
      least = std::min(least, (p - a - (i * (b - a) + j * (c - a)) / kParts).norm());
  }
  return least;
}

/// One layer of a hairpin flies towards the other and along it. Every pair that comes near is found, also
/// where nodes deviate from the expected motion by as much as they may. What only flies past is not listed.
TEST(SelfContact, FindsAllPairsThatComeNearOnTheWay) {
  constexpr double kDeviation = 2e-4;  // [m]
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const double along = seed % 2 == 0 ? 6e-3 : 0.0;  // [m]
    const Grid grid = gridOf(25, 5, 1);
    Folded cloth(grid, mixedLeaves(grid, seed), 0.0);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    const auto noiseOf = [&](double size) {
      return Vec3(size * Vec3(noise(random), noise(random), noise(random)));
    };
    cloth.place([](const Vec3& at) { return hairpin(at, 0.04, 4.0 * kThickness); });
    shake(cloth, random, 1e-4);
    Field end = cloth.x;
    for (int n = 0; n < cloth.mesh.nodes(); ++n) {
      const bool upper = cloth.x[n].z() > 2.0 * kThickness;
      cloth.still.set(n, (upper ? Vec3(along, 0.0, -2.8e-3) : Vec3(0.0, 0.0, 0.0)) + noiseOf(1e-4));
      end.add(n, cloth.still[n] + kDeviation * Vec3(0.0, 0.0, upper ? -1.0 : 1.0));
    }
    cloth.reach.assign(cloth.mesh.nodes(), kDeviation);
    cloth.collect();
    std::set<std::array<int, 4>> found;
    cloth.contact.forPairs([&](const PairPack& pack, int l) {
      if (!pack.lines) found.insert(nodesOf(pack, l));
    });
    int near = 0, past = 0;
    for (std::size_t p = 0; p < cloth.mesh.patches.size(); ++p) {
      for (const int half : {0, 1}) {
        const auto& t = cloth.surface.triangle(static_cast<int>(p), half);
        for (int n = 0; n < cloth.mesh.nodes(); ++n) {
          const Vec3 middle = (cloth.flat(t[0]) + cloth.flat(t[1]) + cloth.flat(t[2])) / 3.0;
          if ((cloth.flat(n) - middle).norm() < 4.0 * kSpacing) continue;  // their range is that of the law
          double least = 1e300, apart = 0.0;
          for (int k = 0; k <= 20; ++k) {
            const auto at = [&](int node) {
              return Vec3(cloth.x[node] + 0.05 * k * (end[node] - cloth.x[node]));
            };
            least = std::min(least, searchedDistance(at(n), at(t[0]), at(t[1]), at(t[2])));
            if (k == 0) apart = least;
          }
          const std::array<int, 4> pair{n, t[0], t[1], t[2]};
          const bool listed = found.count(pair) > 0;
          if (least < kThickness) {
            ++near;
            EXPECT_TRUE(listed) << "seed " << seed << " node " << n;
          } else if (!listed && apart < (cloth.still[n] - cloth.still[t[0]]).norm()) {
            ++past;
          }
        }
      }
    }
    EXPECT_GT(near, 30);
    if (along > 0.0) {
      EXPECT_GT(past, 50);
    }
  }
}

/// Where nothing was near, nothing is searched while the cloth moves little. Criterion: at every step of a
/// motion the pairs are those that a search from the beginning finds, in the same order. A layer comes down
/// on another; and in cloth as thick as its cells are long, whose neighbours are near as soon as they do not
/// count as smooth, a column of cells is squeezed from 0.65 to 0.49 of its width. For a fifth of the time all
/// lie still.
TEST(SelfContact, PairsDoNotDependOnEarlierSearches) {
  struct Case {
    std::function<Vec3(const Vec3& at, double share)> place;  // share of the motion
    LeafMesh leaves;
    double thickness;  // [m]
  };
  const auto down = [](const Vec3& at, double share) {
    return hairpin(at, 0.05, (15.0 - 14.0 * share) * kThickness);
  };
  const auto squeezed = [](const Vec3& at, double share) {
    const int column = static_cast<int>(std::lround(at.x() / kSpacing));
    const double aside = column == 4 ? share : column == 5 ? -share : 0.0;
    return Vec3(at + Vec3(3.3e-4 * aside - (column >= 5 ? 0.348 * kSpacing : 0.0), 0.0, 0.0));
  };
  const auto pairs = [](const Folded& each) {
    std::vector<std::array<int, 4>> list;
    each.contact.forPairs([&](const PairPack& pack, int l) { list.push_back(nodesOf(pack, l)); });
    return list;
  };
  constexpr int kSteps = 1000;
  const Grid grid = gridOf(33, 9, 2);
  for (const Case& c : {Case{down, mixedLeaves(grid, 3), kThickness},
                        Case{squeezed, LeafMesh(gridOf(11, 9, 0), {}, 0), kSpacing}}) {
    const Grid& own = c.leaves.grid();
    Folded kept(own, c.leaves, 0.0, law(c.thickness));
    int empty = 0, found = 0;
    for (int step = 0; step < kSteps; ++step) {
      const auto share = [&](int k) { return static_cast<double>(k - std::max(0, k % 50 - 40)) / kSteps; };
      Folded fresh(own, c.leaves, 0.0, law(c.thickness));
      for (Folded* each : {&kept, &fresh}) {
        each->place([&](const Vec3& at) { return c.place(at, share(step)); });
        for (int n = 0; n < each->mesh.nodes(); ++n) {
          each->still.set(n, c.place(each->flat(n), share(step + 1)) - each->x[n]);
          each->reach[n] = 0.01 * kSpacing;
        }
        each->collect();
      }
      ASSERT_EQ(pairs(kept), pairs(fresh)) << "step " << step;
      pairs(fresh).empty() ? ++empty : ++found;
    }
    EXPECT_GT(empty, 20);
    EXPECT_GT(found, 20);
  }
}

TEST(SelfContact, FlatAndGentlyCurvedClothHasNoPairs) {
  Folded cloth(gridOf(33, 33, 3));
  cloth.collect();
  EXPECT_EQ(cloth.contact.size(), 0);
  cloth.place([](const Vec3& at) {  // a third of a cylinder
    const double radius = 0.06, turn = at.x() / radius;
    return Vec3(radius * std::sin(turn), at.y(), radius * std::cos(turn));
  });
  cloth.collect();
  EXPECT_EQ(cloth.contact.size(), 0);
}

/// Layers that press, far from every probe and in part beside one, where middles of lines press, too.
class ForcesOfLayers : public testing::TestWithParam<bool> {
 protected:
  static std::vector<char> dents(const Folded& cloth) {
    std::vector<char> dented;
    for (const Patch& patch : cloth.mesh.patches) dented.push_back(GetParam() && patch.cell.j < 3 ? 1 : 0);
    return dented;
  }
};

INSTANTIATE_TEST_SUITE_P(Probe, ForcesOfLayers, testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "beside" : "far"); });

/// Differences over 1e-9 m of energies whose third derivative is about p0 A / range² = 1e8 N/m² leave
/// 1e-10 N; rounding of energies of 1e-7 J adds 1e-7 · 1e-16 / 1e-9 = 1e-14 N.
TEST_P(ForcesOfLayers, GradientIsTheDerivativeOfTheEnergy) {
  std::mt19937 random(5);
  Folded cloth(gridOf(25, 9, 0), 0.4);
  cloth.dented = dents(cloth);
  cloth.place([](const Vec3& at) { return hairpin(at, 0.04, 0.5 * kThickness + 0.01 * at.y()); });
  shake(cloth, random, 2e-5);
  cloth.collect();
  ASSERT_GT(cloth.contact.touching(), 20);
  int middles = 0;
  cloth.contact.forPairs([&](const PairPack& pack, int l) { middles += isMiddle(pack, l) ? 1 : 0; });
  ASSERT_EQ(middles > 0, GetParam());
  shake(cloth, random, 2e-6);  // slips, too
  const Field gradient = cloth.gradient();
  double largest = 0.0;
  for (int n = 0; n < cloth.mesh.nodes(); ++n) largest = std::max(largest, gradient[n].norm());
  std::normal_distribution<double> noise;
  for (int trial = 0; trial < 20; ++trial) {
    constexpr double kStep = 1e-9;
    Field ahead = cloth.x, behind = cloth.x;
    double slope = 0.0;
    for (int n = 0; n < cloth.mesh.nodes(); ++n) {
      const Vec3 d(noise(random), noise(random), noise(random));
      ahead.add(n, kStep * d);
      behind.add(n, -kStep * d);
      slope += gradient[n].dot(d);
    }
    EXPECT_NEAR((cloth.energy(ahead) - cloth.energy(behind)) / (2.0 * kStep), slope, 1e-4 * largest);
  }
}

/// Pairs are measured only when they may have a share of the pressure. Forces after a long way in short
/// steps, on which the nearest triangles become far ones, are those after one step to the same place.
/// Criterion: pairs that are left out have less than 1.4 to the power of -64 = 4e-10 of a node's pressure,
/// and 64 times that of its force, at less than ten pairs.
TEST_P(ForcesOfLayers, ForcesDoNotDependOnTheWay) {
  constexpr int kSteps = 40;
  const Vec3 way(1.4 * kSpacing, 0.3 * kSpacing, 0.0);
  Folded cloth(gridOf(25, 9, 0)), other(gridOf(25, 9, 0));
  for (Folded* each : {&cloth, &other}) {
    std::mt19937 random(3);
    each->dented = dents(*each);
    each->place([](const Vec3& at) { return hairpin(at, 0.04, 0.5 * kThickness + 0.01 * at.y()); });
    shake(*each, random, 2e-5);
    each->reach.assign(each->mesh.nodes(), way.norm());
    each->collect();
  }
  double energy = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    moveUpper(cloth, cloth.x, way / kSteps);
    energy = cloth.energy(cloth.x);
  }
  const Field stepped = cloth.gradient();
  other.x = cloth.x;
  EXPECT_NEAR(other.energy(other.x), energy, 1e-8 * energy);
  const Field direct = other.gradient();
  const auto distances = [](const Folded& each) {
    std::vector<double> sum;
    each.contact.forPairs([&](const PairPack& pack, int l) { sum.push_back(pack.distance[l]); });
    return sum;
  };
  EXPECT_NE(distances(cloth), distances(other)) << "no pair was left out";
  double largest = 0.0;
  for (int n = 0; n < other.mesh.nodes(); ++n) largest = std::max(largest, direct[n].norm());
  ASSERT_GT(largest, 0.0);
  for (int n = 0; n < other.mesh.nodes(); ++n)
    EXPECT_LT((direct[n] - stepped[n]).norm(), 3e-7 * largest) << "node " << n;
}

/// The force between the layers of a hairpin is the law's pressure times the area where they lie
/// above each other; the round end carries less than two rows of cells more or less.
TEST_P(ForcesOfLayers, LayersPressByTheLaw) {
  const double fold = 0.12;
  const auto expectLaw = [&](const CompressionLaw& between, double gap) {
    Folded cloth(gridOf(61, 21, 0), 0.0, between);
    cloth.dented = dents(cloth);
    cloth.place([&](const Vec3& at) { return hairpin(at, fold, gap); });
    cloth.collect();
    const Field gradient = cloth.gradient();
    double up = 0.0, sum = 0.0;
    for (int n = 0; n < cloth.mesh.nodes(); ++n) {
      sum += gradient[n].z();
      if (cloth.x[n].z() > 0.9 * gap) up -= gradient[n].z();
    }
    EXPECT_NEAR(sum, 0.0, 1e-12);  // action and reaction
    const double pressure = between(gap).pressure;
    const double width = 20 * kSpacing, length = 0.24 - fold - EIGEN_PI * 0.5 * gap;
    EXPECT_NEAR(up, pressure * width * length, pressure * width * 2.0 * kSpacing);
  };
  expectLaw(law(), 0.6 * kThickness);
  expectLaw(hardLaw(), 0.95 * kThickness);
  for (const double beyond_test : {0.6, 0.3}) expectLaw(hardLaw(), beyond_test * kThickness);
}

/// Layers that stuck start the next step with the same friction, also in a contact that has loaded the
/// state. The upper layer moves by 2e-7 m over gaps of at least 0.5 thicknesses, so normals turn by up to
/// 4e-4, and friction with them.
TEST_P(ForcesOfLayers, FrictionGoesOnWhereItEnded) {
  std::mt19937 random(7);
  Folded cloth(gridOf(25, 9, 0), 0.4);
  cloth.dented = dents(cloth);
  cloth.place([](const Vec3& at) { return hairpin(at, 0.04, 0.5 * kThickness + 0.01 * at.y()); });
  shake(cloth, random, 2e-5);
  const auto friction = [](const SelfContact& contact) {  // sums over all pairs
    double sizes = 0.0;
    Vec3 sum = Vec3::Zero();
    contact.forDrags([&](const DragPack& pack, int l) {
      const Vec3 drag(pack.drag[0][l], pack.drag[1][l], pack.drag[2][l]);
      sizes += drag.norm();
      sum += drag;
    });
    return std::pair(sizes, sum);
  };
  cloth.collect();
  for (int n = 0; n < cloth.mesh.nodes(); ++n) {
    if (cloth.x[n].z() > 0.4 * kThickness) cloth.x.add(n, Vec3(0.0, 2e-7, 0.0));  // the upper layer
  }
  cloth.gradient();
  const auto [sizes, sum] = friction(cloth.contact);
  ASSERT_GT(sizes, 0.0);
  cloth.remember();
  Archive saving;
  cloth.contact.serialize(saving);
  Folded other(gridOf(25, 9, 0), 0.4);
  other.x = cloth.x;
  Archive loading(saving.sealed(), "state");
  other.contact.serialize(loading);
  for (Folded* next : {&cloth, &other}) {
    next->dented = dents(*next);
    next->collect();
    next->gradient();
    const auto [now_sizes, now_sum] = friction(next->contact);
    EXPECT_NEAR(now_sizes, sizes, 4e-4 * sizes);
    EXPECT_NEAR((now_sum - sum).norm(), 0.0, 4e-4 * sizes);
  }
}

/// Friction of layers along a motion. Criteria, as for solids (SamplePacks in lanes_test.cpp): over a whole
/// motion it counts as its force changes, and at least as at the beginning: a difference over 1e-4 of the
/// slip, with an error below 1e-3. The same cloth without friction has the same pressure, so the difference
/// of both forms is friction's alone; it is rounded like their sum.
TEST_P(ForcesOfLayers, FrictionAlongAMotionIsTheChangeOfItsForce) {
  constexpr double kFriction = 0.4;
  Folded cloth(gridOf(25, 9, 0), kFriction), smooth(gridOf(25, 9, 0), 0.0);
  const Vec3 along = Vec3(0.8, 0.6, 0.0), aside(-0.6, 0.8, 0.0);
  for (const double slip : {0.3 * kSlip, 3.0 * kSlip}) {
    for (Folded* each : {&cloth, &smooth}) {
      each->dented = dents(*each);
      each->place([](const Vec3& at) { return hairpin(at, 0.04, 0.5 * kThickness + 0.01 * at.y()); });
      each->collect();
      moveUpper(*each, each->x, slip * along);
      each->energy(each->x);
    }
    for (const double length : {1e-4, 0.3, 30.0}) {
      for (const Vec3& way : {along, Vec3(-along), aside, Vec3((along + aside) / std::sqrt(2.0))}) {
        const Vec3 motion = length * slip * way;
        Field d;
        d.clear(cloth.mesh.nodes());
        moveUpper(cloth, d, motion);
        double expected = 0.0;
        cloth.contact.forDrags([&](const DragPack& pack, int l) {
          const Vec3 normal = laneOf(pack.normal, l), start = laneOf(pack.slip, l);
          Vec3 moved = Vec3::Zero();
          forNodes(pack, l, [&](int n, double weight) { moved += weight * d[n]; });
          moved -= normal.dot(moved) * normal;
          const auto force = [&](const Vec3& y) {
            return pack.limit[l] * smoothSlip(y.norm(), kSlip).ratio * y;
          };
          const double nudge = 1e-4 / length;  // of the motion
          const double whole = (force(start + moved) - force(start)).dot(moved),
                       begins = (force(start + nudge * moved) - force(start)).dot(moved) / nudge;
          expected += std::max(whole, begins);
        });
        if (way == aside) {
          ASSERT_GT(expected, 0.0) << "no layers touch";
        }
        const double with = cloth.contact.quadraticForm(0, cloth.contact.size(), d),
                     without = smooth.contact.quadraticForm(0, smooth.contact.size(), d);
        EXPECT_NEAR(with - without, expected, 1e-3 * expected + 1e-12 * with) << slip << " " << length;
      }
    }
  }
}

/// A step of the largest factor crosses nothing, however wild the direction; ten times as far does.
TEST(SelfContact, LargestStepCrossesNothing) {
  int crossed = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    const Grid grid = gridOf(33, 9, 2);
    Folded cloth(grid, mixedLeaves(grid, seed), 0.0);
    std::mt19937 random(seed);
    cloth.place([](const Vec3& at) { return hairpin(at, 0.05, kThickness + 0.02 * at.y()); });
    ASSERT_EQ(findCrossings(cloth.mesh, cloth.x).pairs, 0);
    std::normal_distribution<double> noise;
    cloth.reach.assign(cloth.mesh.nodes(), 0.02);  // farther than any node goes
    for (int k = 0; k < 30; ++k) {
      cloth.collect();
      Field d;
      d.clear(cloth.mesh.nodes());
      for (int n = 0; n < cloth.mesh.active(); ++n)
        d.set(n, 1e-3 * Vec3(noise(random), noise(random), noise(random)));
      cloth.mesh.interpolateGhosts(d);
      const double step = cloth.contact.maxStep(cloth.x, d, 1e300, 1e-6);
      Field beyond = cloth.x;
      for (int n = 0; n < cloth.mesh.nodes(); ++n) {
        beyond.add(n, 10.0 * step * d[n]);
        cloth.x.add(n, std::min(step, 1.0) * d[n]);
      }
      cloth.mesh.interpolateGhosts(cloth.x);
      EXPECT_EQ(findCrossings(cloth.mesh, cloth.x).pairs, 0) << "seed " << seed << " step " << k;
      cloth.mesh.interpolateGhosts(beyond);
      crossed += findCrossings(cloth.mesh, beyond).pairs > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(crossed, 120);  // of 240: the limit is not far too strict
}

/// Nothing was near at the start, so nothing is listed; the end tells.
TEST(SelfContact, SeesWhatMayHaveMetOnTheWay) {
  Folded cloth(gridOf(33, 17, 2));
  cloth.collect();
  ASSERT_EQ(cloth.contact.size(), 0);
  const Field start = cloth.x;
  const auto staysApart = [&](const auto& place) {
    cloth.place(place);
    cloth.contact.forgetRough();
    return cloth.contact.unlistedStayApart(cloth.mesh, start, cloth.x, true);
  };
  EXPECT_TRUE(staysApart([](const Vec3& at) { return Vec3(at + Vec3(0.1, 0.0, 0.2)); }));
  EXPECT_TRUE(staysApart([](const Vec3& at) { return Vec3(at.x(), at.y(), 0.3 * at.x()); }));
  // Mirrored through itself, and turned back over itself.
  EXPECT_FALSE(staysApart([](const Vec3& at) { return Vec3(-at.x(), at.y(), 0.0); }));
  EXPECT_FALSE(staysApart([](const Vec3& at) { return hairpin(at, 0.06, 0.5 * kThickness); }));
}

/// The layers of a hairpin are pairs. The end tells whether the straight way leads them through each other.
TEST(SelfContact, SeesWhatPairsMayHaveMetOnTheWay) {
  Folded cloth(gridOf(33, 17, 2));
  cloth.place([](const Vec3& at) { return hairpin(at, 0.04, 0.8 * kThickness); });
  cloth.collect();
  ASSERT_GT(cloth.contact.size(), 0);
  const Field start = cloth.x;
  const auto stayApart = [&](const auto& move) {
    Field end = start;
    move(end);
    cloth.energy(end);  // evaluates there
    return cloth.contact.pairsStayApart(start, end);
  };
  EXPECT_TRUE(stayApart([](Field&) {}));
  EXPECT_TRUE(stayApart([&](Field& end) { moveUpper(cloth, end, {0.0, 0.0, -0.7 * kThickness}); }));
  EXPECT_TRUE(stayApart([&](Field& end) { moveUpper(cloth, end, {0.02, 0.0, 0.0}); }));
  EXPECT_TRUE(stayApart([](Field& end) {  // as a whole
    for (int n = 0; n < end.size(); ++n) end.add(n, Vec3(0.3, 0.0, -0.2));
  }));
  EXPECT_FALSE(stayApart([&](Field& end) { moveUpper(cloth, end, {0.0, 0.0, -0.9 * kThickness}); }));
  EXPECT_FALSE(stayApart([](Field& end) {  // mirrored through itself
    for (int n = 0; n < end.size(); ++n) end.set(n, Vec3(end[n].x(), end[n].y(), -end[n].z()));
  }));
  // One node alone.
  EXPECT_FALSE(stayApart([](Field& end) { end.add(2, Vec3(0.0, 0.0, 1.6 * kThickness)); }));
}

/// Two hems are driven through each other by their pins, against which no law helps.
TEST(SelfContact, PinsStopBeforeTheyMeet) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 17, 5, 0.08, 0.02);
  scene.adapt.strategy = Strategy::Finest;
  pin(scene, 0, 0, 0, 4);
  pin(scene, 16, 16, 0, 4);
  scene.cloth.pins[0].velocity = Vec3(0.4, 0.0, 0.0);
  scene.cloth.pins[1].velocity = Vec3(-0.4, 0.0, 0.0);
  Simulation simulation(scene);
  for (int k = 0; k < 200; ++k) {
    const StepReport report = simulation.step();
    ASSERT_EQ(simulation.crossings().pairs, 0) << "step " << k;
    ASSERT_GT(report.min_self_gap, 0.0) << "step " << k;
  }
  EXPECT_TRUE(std::isfinite(simulation.energy().total()));
}

/// Outcome of steps whose solves have one iteration each, because no time is left.
struct CutShort {
  int in_part = 0, failed = 0;

  CutShort(Simulation& simulation, int steps) {
    for (int k = 0; k < steps; ++k) {
      const StepReport report = simulation.step();
      EXPECT_EQ(simulation.crossings().pairs, 0) << "step " << k;
      const bool whole = report.minimizer.motion_made == 1.0;
      EXPECT_EQ(report.minimizer.why, whole ? Termination::TimeBudget : Termination::OutOfReach);
      in_part += !whole && !report.failed ? 1 : 0;
      failed += report.failed ? 1 : 0;
    }
  }
};

void giveNoTime(Scene& scene) {
  scene.solver.time_step = 0.008;
  scene.solver.minimizer.time_budget = 1e-9;  // one iteration
}

/// A node above another layer moves by twice the gap. Bent around all pairs, the whole direction is
/// admissible: each pair uses up the share that maxStep() admits, and no pair loses by another's change.
TEST(SelfContact, DirectionsAreBentAroundPairs) {
  const double gap = 0.5 * kThickness;
  Folded cloth(gridOf(25, 9, 0));
  cloth.place([&](const Vec3& at) { return hairpin(at, 0.04, gap); });
  cloth.reach.assign(cloth.mesh.nodes(), gap);
  cloth.collect();
  Field d, change;
  for (Field* field : {&d, &change}) field->clear(cloth.mesh.nodes());
  EXPECT_FALSE(cloth.contact.keepClear(cloth.x, d, 1.0, change)) << "nothing moves";
  d.set(cloth.mesh.node[4 * 25 + 16], Vec3(0.0, 0.0, -2.0 * gap));
  EXPECT_NEAR(cloth.contact.maxStep(cloth.x, d, 1.0, 1e-6), 0.45, 1e-6);
  ASSERT_TRUE(cloth.contact.keepClear(cloth.x, d, 1.0, change));
  Vec3 sum = Vec3::Zero();
  for (int n = 0; n < cloth.mesh.nodes(); ++n) {
    d.add(n, change[n]);
    sum += change[n];
  }
  EXPECT_GE(cloth.contact.maxStep(cloth.x, d, 1.0, 1e-6), 1.0 - 1e-9);
  EXPECT_LT(sum.norm(), 1e-12 * gap) << "each part yields by half";
}

/// Pins pull the hems of a sheet from rest to 1.4 m/s: more than the first search looks for. If such steps
/// failed, the sheet would stand still for ever, 80 mm long. In the 0.6 s the pins come together in at least
/// half of it.
TEST(SelfContact, StepsCutShortGoOn) {
  LinearFabric linear;
  linear.rigidity = 4e-6;
  linear.compression = 0.1;
  Scene scene = sheetScene(makeFabric(linear), 33, 9, 0.08, 0.02);
  setStrategy(scene, Strategy::Amrc, 2);
  pin(scene, 0, 0, 0, 8);
  pin(scene, 32, 32, 0, 8);
  scene.cloth.pins[0].velocity = Vec3(1.4, 0.0, 0.0);
  scene.cloth.pins[1].velocity = Vec3(-1.4, 0.0, 0.0);
  giveNoTime(scene);
  Simulation simulation(scene);
  EXPECT_EQ(CutShort(simulation, 75).failed, 0);
  EXPECT_LT(particle(simulation, 32, 4).x() - particle(simulation, 0, 4).x(), 0.04);
}

/// Hems turn by 37 degrees in a step, so parts may have met wherever the search looks: such a step is made
/// in part.
TEST(SelfContact, StepsCutShortGoOnInPart) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 33, 33, 0.08, 0.08);
  pin(scene, 0, 0, 0, 32);
  pin(scene, 32, 32, 0, 32);
  scene.gravity = Vec3::Zero();
  scene.cloth.pins[0].turn = Vec3(80.0, 0.0, 0.0);
  scene.cloth.pins[1].turn = Vec3(-80.0, 80.0, 0.0);
  scene.cloth.pins[1].centre = scene.cloth.pose.position + Vec3(0.04, 0.0, 0.0);
  scene.cloth.pins[0].centre = scene.cloth.pose.position - Vec3(0.04, 0.0, 0.0);
  giveNoTime(scene);
  Simulation simulation(scene);
  const CutShort run(simulation, 20);
  EXPECT_GT(run.in_part, 0);
  EXPECT_EQ(run.failed, 0);
}

/// Layers of a hairpin 1.5 thicknesses apart have room to move by a quarter of that, not by three
/// quarters. If their law is hard, they must stay farther apart.
TEST(SelfContact, TellsWhetherAChangeOfTheMeshHasRoom) {
  const double gap = 1.5 * kThickness;
  const auto hasRoom = [&](const CompressionLaw& between, double moved) {
    Folded cloth(gridOf(33, 17, 2), 0.0, between);
    cloth.place([&](const Vec3& at) { return hairpin(at, 0.06, gap); });
    cloth.contact.beginChange(cloth.mesh, cloth.x);
    return cloth.contact.hasRoom(cloth.mesh, cloth.x, {8, 4, 2}, moved);
  };
  EXPECT_TRUE(hasRoom(law(), 0.25 * gap));
  EXPECT_FALSE(hasRoom(law(), 0.75 * gap));
  const double left = 0.5 * (gap - hardLaw().leastRoom());
  EXPECT_GT(hardLaw().leastRoom(), 0.5 * kThickness);
  EXPECT_TRUE(hasRoom(hardLaw(), 0.99 * left));
  EXPECT_FALSE(hasRoom(hardLaw(), 1.01 * left));
}

}  // namespace
}  // namespace haptic_cloth::self_contact_test
