// Kernels of the instruction set in use, against the same formulas for one element, point or
// deformation at a time.
// Criteria: equality except for rounding, because multiplications and additions are contracted
// differently; the bounds are stated where they are used. Lanes past the last element and entries
// past the last node must not matter; the latter are poisoned. ctest runs this for every
// instruction set of the machine.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "contact/contact_law.h"
#include "contact/friction_law.h"
#include "contact/sample_packs.h"
#include "contact/solid.h"
#include "energy/internal_energy.h"
#include "energy/law_table.h"
#include "energy/shear.h"
#include "energy/twist.h"
#include "scene/option.h"
#include "shape/shapes.h"
#include "simd/kernels.h"
#include "support/derivatives.h"
#include "support/scalar_distances.h"
#include "support/scalar_elements.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::lanes_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Relative error of slopes that a kernel stores in single precision, which rounds by 6e-8.
constexpr double kSingle = 1e-6;

// ---- solids ----

std::vector<Obstacle> solids() {
  std::vector<Obstacle> all;
  for (const auto& entry : shapeNames()) {
    Obstacle obstacle;
    obstacle.shape = entry.second;
    obstacle.size = Vec3(0.5, 0.25, 0.125);
    obstacle.radius = 0.25;
    obstacle.length = 0.5;
    all.push_back(obstacle);
  }
  return all;
}

/// @param digits error of the coordinates, which matters where distances are small [m]
void expectSame(const Obstacle& solid, const std::vector<Vec3>& points, double digits) {
  const std::string shape = nameOf(shapeNames(), solid.shape);
  const int count = static_cast<int>(points.size());
  const Field at(points);
  Field normals;
  normals.clear(count);
  std::vector<double> values(padded(count));
  for (const double edge_radius : {0.0, 0.03}) {
    const Solid kept(solid, edge_radius);
    kernels().solidDistances(kept.lanes(), count, at.arrays(), values.data(), normals.arrays());
    for (int l = 0; l < count; ++l) {
      const Distance one = scalarDistance(solid, points[l], edge_radius);
      const Vec3 normal = normals[l];
      EXPECT_NEAR(values[l], one.value, tolerance(digits)) << shape << " at " << points[l].transpose();
      // A normal is an offset over its length, so its error is that of the offset over the length.
      const double length = std::max(std::abs(one.value + edge_radius), 1e-3);
      EXPECT_LT((normal - one.normal).norm(), tolerance(digits) / length + tolerance(1e-14))
          << shape << " at " << points[l].transpose();
      EXPECT_NEAR(normal.norm(), 1.0, tolerance(1e-14));
      const Distance alone = kept.distance(points[l]);  // by the same kernel: the same bits
      EXPECT_EQ(alone.value, values[l]);
      EXPECT_EQ(alone.normal, normal);
    }
  }
}

TEST(SolidLanes, AreTheSolidsAnywhere) {
  unsigned seed = 11;
  for (Obstacle obstacle : solids()) {
    obstacle.pose.position = Vec3(0.3, -0.2, 0.1);
    obstacle.pose.orientation = Quat(0.3, -0.5, 0.4, 0.7).normalized();
    for (const double far : {0.3, 1.0, 1e3, 1e6}) {
      constexpr int kPoints = 317;  // not a multiple of a register
      const Eigen::VectorXd noise = fixedRandom(3 * kPoints, seed);
      std::vector<Vec3> points;
      for (int k = 0; k < kPoints; ++k) {
        points.push_back(obstacle.pose.position + far * noise.segment<3>(3 * k));
      }
      expectSame(obstacle, points, 16 * kEpsilon * std::max(1.0, far));
    }
    ++seed;
  }
}

// Centres, axes, faces, edges, corners and both zeros: exact in binary, so both sides must decide
// alike.
TEST(SolidLanes, AreTheSolidsWhereTheyTurn) {
  const std::vector<double> at{-1.0, -0.25, -0.125, -0.0625, -0.0, 0.0, 0.0625, 0.125, 0.25, 1.0, 0.5, 2.0};
  std::vector<Vec3> points;
  for (const double x : at) {
    for (const double y : at) {
      for (const double z : at) points.emplace_back(x, y, z);
    }
  }
  for (const Obstacle& obstacle : solids()) expectSame(obstacle, points, 4 * kEpsilon);
}

// ---- laws ----

struct PackLaw {
  double potential[kPack], force[kPack], slope[kPack];
};

/// Law at the deformations s of a pack, by triples whose curvature is s. Only one lane at a time
/// has an area, so the energy is that of the lane.
PackLaw lawOfPack(const LawView& law, const double* s, const StepPack& steps) {
  Field x, normals, slots;
  x.clear(2 * kPack);
  normals.clear(2 * kPack);
  TriplePack pack{};
  for (int l = 0; l < kPack; ++l) {
    pack.l.set(l, l);
    pack.c.set(l, kPack + l);
    pack.r.set(l, kPack + l);
    pack.left[l] = 1.0;
    x.set(l, Vec3(0.0, 0.0, s[l]));
    normals.set(kPack + l, Vec3::UnitZ());
  }
  for (PackIndices* nodes : {&pack.l, &pack.c, &pack.r}) nodes->finish();
  PackLaw result;
  for (int l = 0; l < kPack; ++l) {
    slots.clear(kPack);
    pack.area[l] = 1.0;
    result.potential[l] = kernels().evaluateTriples(&pack, nullptr, 0, 1, law, &steps, x.arrays(),
                                                    normals.arrays(), slots.arrays(), 0);
    result.force[l] = slots[l].z();
    result.slope[l] = pack.stiffness[l];
    pack.area[l] = 0.0;
  }
  return result;
}

TEST(LawTable, IsTheLoopOfEveryShippedFabric) {
  int laws = 0;
  for (const auto& entry : std::filesystem::directory_iterator(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics")) {
    const Fabric fabric = loadFabric(entry.path().string());
    for (const auto& [loop, range] : {std::pair(fabric.tensile[kWarp], 0.05),
                                      {fabric.tensile[kWeft], 0.05},
                                      {fabric.bending[kWarp], 300.0},
                                      {fabric.bending[kWeft], 300.0},
                                      {fabric.shear, 0.2}}) {
      const LawTable table(loop);
      const double end =
          std::abs(loop.upper()(range).force) + (loop.hasMemory() ? std::abs(loop.path()(range).force) : 0.0);
      const Eigen::VectorXd noise = fixedRandom(2 * kPack, ++laws);
      for (const double reach : {1e-9, 1e-2, 1.0, 5.0, 1e3, 1e6}) {
        double s[kPack];
        Loop::Step step[kPack];
        StepPack steps;
        for (int l = 0; l < kPack; ++l) {
          s[l] = l == 0 ? 0.0 : reach * range * noise[l];
          step[l] = loop.begin(loop.commit(loop.initialPlay(), 2.0 * range * noise[kPack + l]));
          steps.play[l] = step[l].play;
          steps.low[l] = step[l].low;
          steps.high[l] = step[l].high;
          steps.on_lower[l] = step[l].on_lower;
          steps.on_upper[l] = step[l].on_upper;
          if (l == 1) s[l] = step[l].high;  // where the path joins a branch
          if (l == 2) s[l] = step[l].low;
        }
        const PackLaw lanes = lawOfPack(table.view(), s, steps);
        for (int l = 0; l < kPack; ++l) {
          const Curve::Point one = loop(step[l], s[l]);
          // q + r s and p + s (q + r s / 2) cancel digits of their terms, which are as large as at
          // the table's end.
          const double force = end + std::abs(one.force) + std::abs(one.slope * s[l]);
          const double energy = force * (range + std::abs(s[l]));
          const std::string where = entry.path().filename().string() + " at " + std::to_string(s[l]);
          EXPECT_NEAR(lanes.force[l], one.force, tolerance(8 * kEpsilon) * force) << where;
          EXPECT_NEAR(lanes.potential[l], one.potential, tolerance(8 * kEpsilon) * energy) << where;
          if (l <= 2) continue;  // at a kink either slope is correct
          EXPECT_NEAR(lanes.slope[l], one.slope, tolerance(kSingle) * std::abs(one.slope)) << where;
        }
      }
    }
  }
  EXPECT_GT(laws, 30);
}

// ---- shear angles ----

TEST(ShearLanes, AngleIsTheInverseSine) {
  const std::vector<double> sines{-1.0,
                                  -1.0 + kEpsilon,
                                  -0.999999,
                                  -0.9,
                                  -0.5 - kEpsilon,
                                  -0.5,
                                  -0.1,
                                  -1e-9,
                                  -0.0,
                                  0.0,
                                  1e-300,
                                  1e-5,
                                  0.25,
                                  0.4999999,
                                  0.5,
                                  0.5 + kEpsilon,
                                  0.50001,
                                  0.7071,
                                  0.866,
                                  0.99,
                                  0.9999999,
                                  1.0 - 1e-15,
                                  1.0 - kEpsilon,
                                  1.0};
  ASSERT_EQ(sines.size() % kPack, 0u);
  const LawTable law{Loop(Curve::linear(1.0))};
  for (std::size_t first = 0; first < sines.size(); first += kPack) {
    std::vector<Vec3> corners;
    PatchPack pack{};
    for (int l = 0; l < kPack; ++l) {
      const double s = sines[first + l], c = std::sqrt((1.0 - s) * (1.0 + s));
      const Vec3 u(1.0, 0.0, 0.0), v(s, c, 0.0);
      for (const Vec3& x : {Vec3(0.0, 0.0, 0.0), u, v, Vec3(u + v)}) corners.push_back(x);
      for (int k = 0; k < 4; ++k) pack.corners.at[k].set(l, 4 * l + k);
    }
    for (PackIndices& nodes : pack.corners.at) nodes.finish();
    Field x(corners), slots;
    double energies[kPack];
    // Only one lane at a time has an area: the energy is that of the lane.
    for (int l = 0; l < kPack; ++l) {
      pack.area[l] = 1.0;
      slots.clear(2 * kPack);
      energies[l] =
          kernels().evaluateShears(&pack, 0, 1, law.view(), nullptr, x.arrays(), slots.arrays(), 0, kPack);
      pack.area[l] = 0.0;
    }
    std::fill(std::begin(pack.area), std::end(pack.area), 1.0);
    slots.clear(2 * kPack);
    kernels().evaluateShears(&pack, 0, 1, law.view(), nullptr, x.arrays(), slots.arrays(), 0, kPack);
    for (int l = 0; l < kPack; ++l) {
      const double s = sines[first + l], cosine = std::sqrt(1.0 - s * s),
                   angle = std::atan2(s, std::hypot(cosine, kFlat));
      const auto one =
          evaluateShear({corners[4 * l], corners[4 * l + 1], corners[4 * l + 2], corners[4 * l + 3]}, 1.0,
                        Curve::linear(1.0));
      // The energy is half the square of the angle. An error ε of the sine gives an error ε/cos of
      // the angle, at worst √2ε.
      const double doubt = tolerance(4 * kEpsilon) / std::max(cosine, 1e-8);
      ASSERT_TRUE(slots[l].allFinite() && slots[kPack + l].allFinite()) << s;
      EXPECT_NEAR(std::sqrt(2.0 * energies[l]), std::abs(angle), doubt) << s;
      // The slope is an offset over the cosine, which the error of the sine leaves uncertain by
      // ε/cos²; but no offset is divided by less than kFlat.
      const double cosine_doubt = tolerance(4 * kEpsilon) / std::max(cosine * cosine, kFlat);
      EXPECT_LT((slots[l] - angle * one.rising).norm(), 1.6 * cosine_doubt * (1.0 + one.rising.norm())) << s;
      const Vec3 slope(pack.rising_x[l], pack.rising_y[l], pack.rising_z[l]);
      EXPECT_LT((slope - one.rising).norm(),
                1.6 * cosine_doubt * (1.0 + one.rising.norm()) + tolerance(kSingle) * one.rising.norm())
          << s;
    }
  }
}

// ---- elements and nodes ----

/// Fills the entries past the last one with NaN.
void poison(Field& field) {
  for (int c = 0; c < 3; ++c) {
    auto& values = field.coordinate(c);
    std::fill(values.begin() + field.size(), values.end(), std::numeric_limits<double>::quiet_NaN());
  }
}

struct Reference {
  double energy = 0.0;
  Field gradient, diagonal;
};

/// Sum of energies, gradients and diagonals over the elements, one at a time. @pre no law has
/// memory
Reference sumOfElements(const Fabric& fabric, const ActiveMesh& mesh, const InternalEnergy& internal,
                        const Field& x) {
  Reference sum;
  sum.gradient.clear(mesh.nodes());
  const auto point = [](const Loop& law) { return [&law](double s) { return law(Loop::Step{}, s); }; };
  for (const Edge& e : mesh.edges) {
    const EdgeResult r = evaluateEdge(x[e.a], x[e.b], e.length, e.width, point(fabric.tensile[e.direction]));
    sum.energy += r.energy;
    sum.gradient.add(e.b, r.gradient);
    sum.gradient.add(e.a, -r.gradient);
  }
  for (const Triple& t : mesh.triples) {
    const Vec3 normal = internal.normal(t.c);
    const TripleResult r = evaluateTriple(t.bent(x), normal, t.area, point(fabric.bending[t.direction]));
    sum.energy += r.energy;
    for (const auto& [node, part] : t.parts()) sum.gradient.add(node, part * r.moment * normal);
  }
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const auto& n = mesh.patches[k].nodes;
    const std::array<Vec3, 4> corners{x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
    const ShearResult r = evaluateShear(corners, mesh.patches[k].area, point(fabric.shear));
    const Vec3 normal = internal.patchNormal(static_cast<int>(k));
    const TwistResult twist = evaluateTwist(corners, normal, fabric.twist_rigidity, mesh.patches[k].area);
    sum.energy += r.energy + twist.energy;
    sum.gradient.add(n[3], r.force * r.rising + twist.gradient * normal);
    sum.gradient.add(n[0], -r.force * r.rising + twist.gradient * normal);
    sum.gradient.add(n[1], r.force * r.falling - twist.gradient * normal);
    sum.gradient.add(n[2], -r.force * r.falling - twist.gradient * normal);
  }
  return sum;
}

// Parameters: columns, rows, levels, splits.
class PackTest : public ::testing::TestWithParam<std::array<int, 4>> {};

TEST_P(PackTest, AddUpToTheElements) {
  const auto [columns, rows, levels, splits] = GetParam();
  LinearFabric linear;
  linear.rigidity = 1e-5;
  linear.compression = 0.1;
  Fabric fabric = makeFabric(linear);
  fabric.twist_rigidity = 2e-5;
  const Grid grid{columns, rows, levels, 0.004, 0.005};
  LeafMesh leaves(grid, {{0, 0, 0, 0}}, levels);
  std::vector<Cell> done;
  const Eigen::VectorXd where = fixedRandom(2 * splits + 1, 3);
  for (int k = 0; k < splits; ++k) {
    leaves.split(leaves.leafAt(static_cast<int>((0.5 + 0.5 * where[2 * k]) * (columns - 1.001)),
                               static_cast<int>((0.5 + 0.5 * where[2 * k + 1]) * (rows - 1.001))),
                 done);
  }
  const ActiveMesh mesh(leaves, 0.15);
  InternalEnergy internal(fabric, mesh);
  Field x, gradient;
  x.clear(mesh.nodes());
  gradient.clear(mesh.nodes());
  const Eigen::VectorXd noise = fixedRandom(3 * mesh.nodes(), 5);
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    x.set(n, Vec3(grid.column(p) * 0.004, grid.row(p) * 0.005, 0.0) + 3e-4 * noise.segment<3>(3 * n));
  }
  internal.setNormals(x);
  poison(x);
  poison(gradient);
  double energy = 0.0;
  // In parts, as for several threads.
  for (int begin = 0; begin < internal.size(); begin += 2 * kPack) {
    const auto e = internal.evaluate(begin, std::min(begin + 2 * kPack, internal.size()), x);
    energy += e.stretch + e.bend + e.shear;
  }
  internal.addGradient(0, mesh.nodes(), gradient);
  const Reference sum = sumOfElements(fabric, mesh, internal, x);
  EXPECT_NEAR(energy, sum.energy, tolerance(1e-12) * sum.energy);
  double largest = 0.0;
  for (int n = 0; n < mesh.nodes(); ++n) largest = std::max(largest, sum.gradient[n].norm());
  for (int n = 0; n < mesh.nodes(); ++n) {
    EXPECT_LT((gradient[n] - sum.gradient[n]).norm(), tolerance(1e-12) * largest) << n;
  }
  // The quadratic form d · H⁺ d is a sum over all packs, too; entries past the last node must not
  // enter.
  Field d = x;
  EXPECT_TRUE(std::isfinite(internal.quadraticForm(0, internal.size(), d)));
}

INSTANTIATE_TEST_SUITE_P(Meshes, PackTest,
                         testing::Values(std::array<int, 4>{2, 2, 0, 0}, std::array<int, 4>{2, 129, 0, 0},
                                         std::array<int, 4>{129, 2, 0, 0}, std::array<int, 4>{3, 5, 0, 0},
                                         std::array<int, 4>{3, 5, 1, 0}, std::array<int, 4>{3, 5, 1, 1},
                                         std::array<int, 4>{17, 13, 2, 0}, std::array<int, 4>{17, 13, 2, 5},
                                         std::array<int, 4>{33, 17, 4, 9}));

// ---- contact samples ----

TEST(SamplePacks, AreTheLawsOfContactAndFriction) {
  constexpr double kRange = 5e-4, kSlip = 3e-7;
  int count = 0;
  for (Obstacle obstacle : solids()) {
    obstacle.pose.orientation = Quat(0.3, -0.5, 0.4, 0.7).normalized();
    const SampleContext context{Solid(obstacle).lanes(), {}, {0.0, 0.0, 0.0}, false, kRange, kSlip};
    const Eigen::VectorXd noise = fixedRandom(7 * kPack, 17 + count++);
    std::vector<Vec3> points;
    SamplePack pack{};
    for (int l = 0; l < kPack; ++l) {
      // Gaps from beyond the range to beyond the switch, in the order of lanes.
      const Vec3 from = noise.segment<3>(3 * l);
      const Distance there = scalarDistance(obstacle, from);
      points.push_back(from - (there.value - (1.2 - 0.25 * l) * kRange) * there.normal);
      pack.nodes[0].index[l] = l;
      pack.weights[0][l] = 1.0;
      const Distance here = scalarDistance(obstacle, points[l]);
      for (int c = 0; c < 3; ++c) {
        pack.start[c][l] = points[l][c] + (l < 4 ? 1.0 : 1e3) * 1e-7 * noise[3 * kPack + 3 * l + c];
        pack.start_normal[c][l] = here.normal[c];
      }
      pack.area[l] = 1e-6 * (1 + l);
      pack.friction[l] = 1e-3 * l;
      pack.gap_offset[l] = here.value < 0.0 ? 1e-5 - here.value : 0.0;
      pack.firmest_gap[l] = l % 2 == 0 ? ContactLaw::kNoLimit : 2e-5;
    }
    pack.at_nodes = true;
    pack.nodes[0].finish();
    Field x(points), slots;
    slots.clear(kPack);
    const ContactEnergy energy =
        kernels().evaluateSamples(&pack, 0, 1, context, x.arrays(), slots.arrays(), 0);
    double contact = 0.0, friction = 0.0;
    for (int l = 0; l < kPack; ++l) {
      const Distance d = scalarDistance(obstacle, points[l]);
      const ContactLaw::Point law = ContactLaw(kRange)(d.value + pack.gap_offset[l], pack.firmest_gap[l]);
      const Vec3 normal(pack.start_normal[0][l], pack.start_normal[1][l], pack.start_normal[2][l]);
      const Vec3 moved = points[l] - Vec3(pack.start[0][l], pack.start[1][l], pack.start[2][l]);
      const Vec3 slip = moved - normal.dot(moved) * normal;
      const SmoothSlip smooth = smoothSlip(slip.norm(), kSlip);
      contact += pack.area[l] * law.energy;
      friction += pack.friction[l] * smooth.potential;
      const Vec3 force = pack.friction[l] * smooth.ratio * slip - pack.area[l] * law.pressure * d.normal;
      // Distances have an error of ε metres: over the range that is 1e-12 of u, amplified by the
      // stiffness.
      const double doubt =
          pack.area[l] * law.stiffness * 8 * kEpsilon + pack.friction[l] / kSlip * 8 * kEpsilon;
      EXPECT_LE((slots[l] - force).norm(), tolerance(1e-11) * force.norm() + tolerance(1.0) * doubt) << l;
      EXPECT_NEAR(pack.gap[l], d.value, tolerance(8 * kEpsilon));
    }
    EXPECT_GT(contact, 0.0);
    EXPECT_NEAR(energy.contact, contact, tolerance(1e-9) * contact);
    EXPECT_NEAR(energy.friction, friction, tolerance(1e-9) * friction);
  }
}

// Criteria: by definition. Along a motion friction counts as its force changes over the whole of it, or,
// while the minimizer iterates, at least as at its beginning: the derivative of the force, a difference over
// 1e-4 of the slip, whose error of second order is below 1e-3. Motions slide on, turn back, break loose and
// go aside.
TEST(SamplePacks, FrictionAlongAMotionIsTheChangeOfItsForce) {
  constexpr double kRange = 5e-4, kSlip = 3e-7, kLimit = 1e-3;
  Obstacle floor;
  floor.shape = Shape::Plane;
  const SampleContext context{Solid(floor).lanes(), {}, {0.0, 0.0, 0.0}, false, kRange, kSlip};
  const auto force = [&](const Vec3& slip) { return kLimit * smoothSlip(slip.norm(), kSlip).ratio * slip; };
  SamplePack pack{};
  std::vector<Vec3> points, slips;
  for (int l = 0; l < kPack; ++l) {
    slips.push_back(std::pow(10.0, -2.0 + 0.7 * l) * kSlip * Vec3(std::cos(l), std::sin(l), 0.0));
    points.push_back(Vec3(0.1 * l, 0.0, 2.0 * kRange));
    pack.nodes[0].index[l] = l;
    pack.weights[0][l] = 1.0;
    for (int c = 0; c < 3; ++c) pack.start[c][l] = points[l][c] - slips[l][c];
    pack.start_normal[2][l] = 1.0;
    pack.area[l] = 1e-6;
    pack.friction[l] = kLimit;
  }
  pack.at_nodes = true;
  pack.nodes[0].finish();
  Field slots;
  slots.clear(kPack);
  kernels().evaluateSamples(&pack, 0, 1, context, Field(points).arrays(), slots.arrays(), 0);
  for (int l = 0; l < kPack; ++l) {
    const Vec3 along = slips[l].normalized(), aside(-along.y(), along.x(), 0.0);
    for (const double length : {1e-4, 0.3, 1.0, 30.0}) {
      for (const Vec3& way : {along, Vec3(-along), aside, Vec3((along + aside) / std::sqrt(2.0))}) {
        const Vec3 d = length * slips[l].norm() * way;
        Field motion;
        motion.clear(kPack);
        motion.set(l, d + Vec3(0.0, 0.0, d.norm()));  // away from the floor: friction does not care
        const auto form = [&](bool whole_motion) {
          return kernels().sampleQuadraticForm(&pack, 0, 1, motion.arrays(), SolidMotion{}, kSlip,
                                               whole_motion);
        };
        const double whole = (force(slips[l] + d) - force(slips[l])).dot(d);
        const Vec3 nudge = 1e-4 * slips[l].norm() * way;
        const double begins = length * length * 1e8 * (force(slips[l] + nudge) - force(slips[l])).dot(nudge);
        // Terms cancel and leave their rounding, in `begins` 1e4 times the length of the motion of it.
        const double doubt = 1e-15 * force(slips[l]).norm() * d.norm() * std::max(1e3, 1e4 * length);
        EXPECT_NEAR(form(true), whole, tolerance(1e-6) * whole + doubt) << l << " " << length;
        const double expected = std::max(begins, whole);
        EXPECT_NEAR(form(false), expected, tolerance(1e-3) * expected + doubt) << l << " " << length;
      }
    }
  }
}

}  // namespace
}  // namespace haptic_cloth::lanes_test
