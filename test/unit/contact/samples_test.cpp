/// Contact samples of coarse cells, and their room beside obstacles.
/// Criteria: the energy of a cell tilted over a plane is ∫ψ(gap) dA. The trapezoidal rule of
/// spacing δ has an error of at most δ²/12 · max|d²ψ/ds²| · A, with d²ψ/ds² = slope² · stiffness.
/// An edge that slants is felt within 0.1 ranges of where it is: SampleFinder takes gaps that differ by
/// less for one gap. Numbers of samples are counted. The limits of room are those of docs/model.md (The
/// adaptive mesh).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/contact_set.h"
#include "contact/solid.h"
#include "support/tolerance.h"

namespace haptic_cloth::samples_test {
namespace {

constexpr double kRange = 5e-4, kLow = 2e-4, kHigh = 7e-4;  // gaps at both ends of the cell [m]

struct Contact {
  double energy;  ///< [J]
  int samples;
};

/// Contact of a cloth with one obstacle. Its leaves are as coarse as its grid allows.
/// @param reach of the nodes in the step [m]  @param place of particle (column, row) [m]
template <class Place>
Contact contactOf(const Grid& grid, const Obstacle& obstacle, double reach, const Place& place) {
  const ActiveMesh mesh(LeafMesh(grid, {}, grid.levels), 0.15);
  Team team(1);
  ContactSet contacts(grid, {obstacle}, {}, {kRange, 1e-3, 1e-3}, team);
  Field nodes, still;
  nodes.resize(mesh.nodes());
  still.clear(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n)
    nodes.set(n, place(grid.column(mesh.particle[n]), grid.row(mesh.particle[n])));
  contacts.collectProbes(mesh, nodes, std::vector<double>(mesh.nodes(), reach), still, {});
  contacts.collectObstacles(mesh, nodes, std::vector<double>(mesh.nodes(), reach), still);
  return {contacts.evaluate(0, contacts.size(), nodes).solids, contacts.size()};
}

struct Tilted {
  double energy, bound;  ///< measured minus exact energy, and its bound [J]
  int samples;
};

/// One coarse cell of 2^levels × 2^levels finest cells of a given spacing [m], which rises from one
/// gap to the other.
Tilted tilted(int levels, double spacing) {
  const int side = 1 << levels;
  const Grid grid{side + 1, side + 1, levels, spacing, spacing};
  Obstacle floor;
  floor.shape = Shape::Plane;
  const Contact contact = contactOf(grid, floor, kHigh, [&](double column, double row) {
    return Vec3(spacing * column, spacing * row, kLow + column / side * (kHigh - kLow));
  });

  const ContactLaw law(kRange);
  constexpr int kParts = 100000;
  double mean = 0.0, stiffest = 0.0;
  for (int k = 0; k < kParts; ++k) {
    const ContactLaw::Point at = law(kLow + (k + 0.5) / kParts * (kHigh - kLow));
    mean += at.energy / kParts;
    stiffest = std::max(stiffest, at.stiffness);
  }
  const double area = std::pow(side * spacing, 2), parts = std::ceil(side * spacing / (0.5 * kRange));
  const double most = std::min<double>(side, parts);
  return {contact.energy - mean * area, std::pow((kHigh - kLow) / most, 2) / 12.0 * stiffest * area,
          contact.samples};
}

TEST(Samples, OfACoarseCellStandAtTheFinestSpacing) {
  const Tilted cell = tilted(3, 4e-4);
  EXPECT_LT(std::abs(cell.energy), tolerance(cell.bound));
  EXPECT_GE(cell.samples, 81) << "all points of the finest grid";
}

TEST(Samples, OfAVeryFineGridStandNoCloserThanThePressureAsks) {
  const Tilted cell = tilted(6, 2.5e-5);  // 1.6 mm in 64 parts, 7 times half the range
  EXPECT_LT(std::abs(cell.energy), tolerance(cell.bound));
  EXPECT_LE(cell.samples, 64 + 2 * kPack);
}

/// Edges are rounded by the range. Where both faces slant by 45°, that lifts the lowest line by this [m].
const double kLifted = (std::sqrt(2.0) - 1.0) * kRange;

/// Energy of two level cells in a row, each 4 mm long, under the edge of a box turned by 45° about it, minus
/// the integral of ψ; the gap under the edge is 0.6 ranges. @param edge place of the edge along the cells [m]
struct UnderEdge {
  double error, bound;  ///< [J]
};

UnderEdge underEdge(double edge) {
  constexpr double kSide = 0.004, kGap = 0.6 * kRange;
  const Grid grid{3, 2, 0, kSide, kSide};
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3(0.1, 0.1, 0.1);
  box.pose.orientation = Quat(Eigen::AngleAxisd(0.25 * EIGEN_PI, Vec3::UnitY()));
  box.pose.position = Vec3(edge, 0.0, kGap - kLifted + 0.05 * std::sqrt(2.0));
  const double measured = contactOf(grid, box, kRange, [&](double column, double row) {
                            return Vec3(kSide * column, kSide * (row - 0.5), 0.0);
                          }).energy;

  // The middles of parts of length δ miss at most δ²/24 ∫|d²ψ/ds²| ds.
  const ContactLaw law(kRange);
  constexpr int kParts = 100000;
  constexpr double kStep = 2.0 * kSide / kParts;
  const auto energy = [&](double s) {  // around the arc, whose radius is the range
    return law(std::hypot(kGap + kRange, s - edge) - kRange).energy;
  };
  double exact = 0.0, bent = 0.0;
  for (int k = 0; k < kParts; ++k) {
    const double s = (k + 0.5) * kStep;
    exact += kSide * kStep * energy(s);
    bent += kSide * std::abs(energy(s - kStep) - 2.0 * energy(s) + energy(s + kStep)) / kStep;
  }
  return {measured - exact, std::pow(0.5 * kRange, 2) / 24.0 * bent};
}

TEST(Samples, UnderASharpEdgeFindItWhereverTheNodesLie) {
  for (int k = 0; k <= 32; ++k) {
    const double edge = 0.001 + 0.006 * k / 32;
    SCOPED_TRACE(edge);
    const UnderEdge cells = underEdge(edge);
    EXPECT_LT(std::abs(cells.error), tolerance(cells.bound));
  }
}

constexpr double kCell = 0.004;  // [m]

/// The lowest edge of a box turned by 45° about it, or the lowest point of the rim of an oblique cylinder,
/// above a place of the cloth [m].
/// @param heading of the edge from the weft [rad]
Obstacle edgeAbove(Shape shape, double heading, const Vec3& place) {
  constexpr double kHalf = 0.05, kRadius = 0.02;
  Obstacle solid;
  solid.shape = shape;
  solid.size = Vec3(2.0 * kHalf, 2.0 * kHalf, 2.0 * kHalf);
  solid.radius = kRadius;
  solid.length = 2.0 * kHalf;
  const Vec3 lowest(shape == Shape::Box ? -kHalf : -kRadius, 0.0, -kHalf);
  solid.pose.orientation =
      Quat(Eigen::AngleAxisd(heading, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.25 * EIGEN_PI, Vec3::UnitY()));
  solid.pose.position = place - solid.pose.orientation * lowest - Vec3(0.0, 0.0, kLifted);
  return solid;
}

/// Contact of 2 x 2 level cells around the origin below a solid.
/// @param side of a cell [m]
Contact contactBelow(const Obstacle& solid, double side, double reach) {
  return contactOf(Grid{3, 3, 0, side, side}, solid, reach, [&](double column, double row) {
    return Vec3(side * (column - 1.0), side * (row - 1.0), 0.0);
  });
}

/// Integral of ψ over 2 x 2 cells of kCell below a solid [J].
double energyBelow(const Obstacle& obstacle) {
  const ContactLaw law(kRange);
  const Solid solid(obstacle, kRange);
  constexpr int kParts = 100;
  constexpr double kStep = 2.0 * kCell / kParts;
  double energy = 0.0;
  for (int j = 0; j < kParts; ++j) {
    for (int i = 0; i < kParts; ++i) {
      const Vec3 place(kStep * (i + 0.5) - kCell, kStep * (j + 0.5) - kCell, 0.0);
      energy += kStep * kStep * law(solid.distance(place).value).energy;
    }
  }
  return energy;
}

class Slanting : public testing::TestWithParam<std::tuple<Shape, double>> {};

INSTANTIATE_TEST_SUITE_P(Edges, Slanting,
                         testing::Combine(testing::Values(Shape::Box, Shape::Cylinder),
                                          testing::Values(0.5, 0.65, 0.25 * EIGEN_PI, 0.95)));

TEST_P(Slanting, EdgeIsFeltWhereItIs) {
  constexpr double kGap = 0.6 * kRange, kMostOff = 0.1 * kRange;
  const auto& [shape, heading] = GetParam();
  for (int k = 0; k < 25; ++k) {
    const Vec3 place(1e-3 * (k % 5 - 2), 0.7e-3 * (k / 5 - 2), kGap);
    SCOPED_TRACE(place.transpose());
    const auto edge = [&, shape = shape, heading = heading](double lifted) {
      return edgeAbove(shape, heading, place + lifted * Vec3::UnitZ());
    };
    const double energy = contactBelow(edge(0.0), kCell, kRange).energy;
    EXPECT_LT(energy, energyBelow(edge(-tolerance(kMostOff))));
    EXPECT_GT(energy, energyBelow(edge(tolerance(kMostOff))));
  }
}

// Cloth sinks in where no sample stands for it, until one appears there and begins a step inside the solid.
TEST(Samples, StandWhereAFoldCrossesAnEdge) {
  Obstacle box;  // its edge runs along weft, through the middles of cells
  box.shape = Shape::Box;
  box.size = Vec3(0.1, 0.2, 0.1);
  box.pose.position = Vec3(0.005, 0.01, 0.0) - 0.5 * Vec3(box.size.x(), 0.0, box.size.z());
  const Grid grid{3, 3, 0, 0.01, 0.01};
  const Contact contact = contactOf(grid, box, 0.0, [&](double column, double row) {
    return Vec3(0.01 * column, 0.01 * row, 0.3 * kRange + 0.003 * std::abs(row - 1.0));
  });
  EXPECT_GT(contact.energy, 0.0);
}

TEST(Samples, UnderASlantingEdgeAreNoMoreThanWideCellsNeed) {
  // T1 in bench/peers has such cells: so coarse a cloth cannot tell to half a millimetre where in a cell of
  // 25 mm an edge is. At most 12 parts of each cell, both ways (docs/decisions/0041), and packs that are not
  // full.
  const Obstacle edge = edgeAbove(Shape::Box, 0.25 * EIGEN_PI, Vec3(0.0, 0.0, 0.6 * kRange));
  const Contact contact = contactBelow(edge, 0.025, 5.0 * kRange);
  EXPECT_GT(contact.energy, 0.0);
  EXPECT_LE(contact.samples, 4 * 12 * 12 + 2 * kPack);
}

/// Number of samples of a flat cell under a ball that is nearest to one corner of it. @param gap there [m]
int samplesBeyondTheCorner(double gap, double reach) {
  constexpr double kSide = 0.01;
  const Grid grid{2, 2, 0, kSide, kSide};
  Obstacle ball;
  ball.shape = Shape::Sphere;
  ball.radius = 0.02;
  ball.pose.position = Vec3(1.0, 1.0, 0.0).normalized() * (kSide * std::sqrt(2.0) + ball.radius + gap);
  return contactOf(grid, ball, reach,
                   [&](double column, double row) { return Vec3(kSide * column, kSide * row, 0.0); })
      .samples;
}

TEST(Samples, AnObstacleCountsUpToItsRangeAndTheReachOfTheCloth) {
  // At the corner the ball around the cloth ends, too, so nothing there is left out too early.
  EXPECT_GT(samplesBeyondTheCorner(0.99 * kRange, 0.0), 0);
  EXPECT_EQ(samplesBeyondTheCorner(1.01 * kRange, 0.0), 0);
  EXPECT_GT(samplesBeyondTheCorner(kRange + 0.99e-3, 1e-3), 0);
  EXPECT_EQ(samplesBeyondTheCorner(kRange + 1.01e-3, 1e-3), 0);
}

TEST(ContactSet, ACoarseCellThatMovesMaySinkIntoAnObstacle) {
  // One that moves by no more than half the range cannot pass the law's layer.
  const Grid grid{3, 3, 1, 0.01, 0.01};
  const LeafMesh leaves(grid, {}, 0);
  const ActiveMesh mesh(leaves, 0.15);
  Obstacle floor;
  floor.shape = Shape::Plane;
  Team team(1);
  const ContactSet contacts(grid, {floor}, {}, {kRange, 1e-3, 1e-3}, team);
  const auto maySink = [&](double gap, double moved) {
    Field nodes;
    nodes.clear(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) {
      const int p = mesh.particle[n];
      // Only the middle of one side is so near.
      const double height = grid.column(p) == 2 && grid.row(p) == 1 ? gap : 0.1;
      nodes.set(n, Vec3(0.01 * grid.column(p), 0.01 * grid.row(p), height));
    }
    return contacts.maySink(mesh, nodes, Cell{0, 0, 1}, moved);
  };
  EXPECT_FALSE(maySink(0.0, 0.49 * kRange));
  EXPECT_TRUE(maySink(0.0, 0.51 * kRange));
  EXPECT_TRUE(maySink(1.99 * kRange, kRange));
  EXPECT_FALSE(maySink(2.01 * kRange, kRange));
}

}  // namespace
}  // namespace haptic_cloth::samples_test
