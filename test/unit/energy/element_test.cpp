// Derivative suite for every element energy: zero at rest, gradient equal to central differences,
// no net force, invariance under rigid motion, and stiffness equal to differences of forces where
// the energy is convex.
// Criterion: central differences with step s have errors of O(s²) and O(ε/s), so 1e-6 relative at s
// = 1e-6 of a unit length [Nocedal & Wright 2006, 8.1]; invariance to round-off.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/contact_law.h"
#include "contact/friction_law.h"
#include "mesh/active_mesh.h"
#include "support/derivatives.h"
#include "support/scalar_elements.h"
#include "support/tolerance.h"

namespace haptic_cloth::element_test {
namespace {

using Eigen::VectorXd;

/// Energy of some points, with its gradient.
struct Element {
  const char* name;
  int points;
  VectorXd rest;  // positions at which the energy is zero
  std::function<double(const VectorXd&)> energy;
  std::function<VectorXd(const VectorXd&)> gradient;
  bool rotates = true;  // invariant under rotation of the points alone
};

Vec3 point(const VectorXd& x, int k) { return x.segment<3>(3 * k); }

const Curve& stiffening() {  // smooth toe as in KES tensile laws: f = 1000 s² for s > 0, 20 s below
  static const Curve curve = [] {
    std::vector<double> forces{-20.0 * 1e-4};
    for (int k = 0; k <= 2000; ++k) forces.push_back(1000.0 * std::pow(1e-4 * k, 2));
    return Curve(-1e-4, 1e-4, forces);
  }();
  return curve;
}

VectorXd points(std::initializer_list<Vec3> list) {
  VectorXd x(3 * list.size());
  int k = 0;
  for (const Vec3& p : list) x.segment<3>(3 * k++) = p;
  return x;
}

Element edge() {
  const auto evaluate = [](const VectorXd& x) {
    return evaluateEdge(point(x, 0), point(x, 1), 1.0, 0.7, stiffening());
  };
  return {"edge", 2, points({{0, 0, 0}, {1, 0, 0}}), [=](const VectorXd& x) { return evaluate(x).energy; },
          [=](const VectorXd& x) {
            const Vec3 g = evaluate(x).gradient;
            return points({-g, g});
          }};
}

Element triple() {
  const Vec3 normal = Vec3(0.1, -0.2, 1.0).normalized();
  const Triple triple{0, 1, 2, kWarp, 1.0, 0.5, 1.5, 1.0, 0.2, 3, 4};
  const Curve bending = Curve::linear(2.0);
  const auto evaluate = [=](const VectorXd& x) {
    Field nodes;
    nodes.resize(5);
    for (int n = 0; n < 5; ++n) nodes.set(n, point(x, n));
    return evaluateTriple(triple.bent(nodes), normal, triple.area, bending);
  };
  return {"triple",
          5,
          points({{-1, 0, 0}, {0, 0, 0}, {2, 0, 0}, {0, -1, 0}, {0, 1, 0}}),
          [=](const VectorXd& x) { return evaluate(x).energy; },
          [=](const VectorXd& x) {
            VectorXd gradient(15);
            for (const auto& [node, part] : triple.parts()) {
              gradient.segment<3>(3 * node) = part * evaluate(x).moment * normal;
            }
            return gradient;
          },
          false};
}

Element shear() {
  static const Curve law = Curve::linear(30.0);
  const auto evaluate = [](const VectorXd& x) {
    return evaluateShear({point(x, 0), point(x, 1), point(x, 2), point(x, 3)}, 0.8, law);
  };
  return {
      "shear", 4, points({{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}, {1, 0.8, 0}}),
      [=](const VectorXd& x) { return evaluate(x).energy; },
      [=](const VectorXd& x) {
        const ShearResult r = evaluate(x);
        return points({-r.force * r.rising, r.force * r.falling, -r.force * r.falling, r.force * r.rising});
      }};
}

class ElementTest : public ::testing::TestWithParam<int> {
 protected:
  Element element() const { return GetParam() == 0 ? edge() : GetParam() == 1 ? triple() : shear(); }
};

TEST_P(ElementTest, ZeroAtRest) {
  const Element e = element();
  EXPECT_NEAR(e.energy(e.rest), 0.0, tolerance(1e-15)) << e.name;
  EXPECT_LT(e.gradient(e.rest).norm(), tolerance(1e-12) + 1e-300) << e.name;
}

TEST_P(ElementTest, GradientIsTheDerivative) {
  const Element e = element();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const VectorXd x = e.rest + 0.08 * fixedRandom(static_cast<int>(e.rest.size()), seed);
    // The tabulated law has kinks 1e-4 apart; the difference spans few of them.
    EXPECT_LT(gradientError(e.energy, e.gradient, x, 1e-6, 1e-3), tolerance(1e-4))
        << e.name << " seed " << seed;
  }
}

TEST_P(ElementTest, ForcesSumToZero) {
  const Element e = element();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const VectorXd x = e.rest + 0.3 * fixedRandom(static_cast<int>(e.rest.size()), seed);
    const VectorXd g = e.gradient(x);
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    for (int k = 0; k < e.points; ++k) {
      force += point(g, k);
      moment += point(x, k).cross(point(g, k));
    }
    EXPECT_LT(force.norm(), tolerance(1e-13) * (1.0 + g.norm())) << e.name;
    if (e.rotates) {
      EXPECT_LT(moment.norm(), tolerance(1e-12) * (1.0 + g.norm())) << e.name;
    }
  }
}

TEST_P(ElementTest, RigidMotionChangesNothing) {
  const Element e = element();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const VectorXd x = e.rest + 0.3 * fixedRandom(static_cast<int>(e.rest.size()), seed);
    VectorXd moved = x;
    for (int k = 0; k < e.points; ++k) {
      moved.segment<3>(3 * k) = (e.rotates ? Vec3(turn * point(x, k)) : point(x, k)) + Vec3(3, -2, 1);
    }
    EXPECT_NEAR(e.energy(moved), e.energy(x), tolerance(1e-11) * (1.0 + e.energy(x))) << e.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ElementTest, ::testing::Values(0, 1, 2));

TEST(EdgeTest, QuadraticFormIsTheSecondDerivativeInTension) {
  const Curve law = Curve::linear(50.0);
  const Element e{"edge", 2, points({{0, 0, 0}, {1.2, 0.1, 0}}), {}, [&](const VectorXd& x) {
                    const Vec3 g = evaluateEdge(point(x, 0), point(x, 1), 1.0, 0.7, law).gradient;
                    return points({-g, g});
                  }};
  const EdgeResult r = evaluateEdge(point(e.rest, 0), point(e.rest, 1), 1.0, 0.7, law);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const VectorXd d = fixedRandom(6, seed);
    const double exact = differenceQuadraticForm(e.gradient, e.rest, d, 1e-6);
    EXPECT_NEAR(edgeQuadraticForm(r.axis, r.along, r.across, point(d, 1) - point(d, 0)), exact,
                tolerance(1e-6) * exact);
  }
}

TEST(EdgeTest, DegenerateEdgeIsFinite) {
  const EdgeResult r = evaluateEdge(Vec3::Zero(), Vec3::Zero(), 1.0, 1.0, stiffening());
  EXPECT_TRUE(std::isfinite(r.energy));
  EXPECT_TRUE(r.gradient.allFinite());
}

TEST(ShearTest, DegenerateCellIsFinite) {
  const ShearResult r =
      evaluateShear({Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, 1.0, Curve::linear(1));
  EXPECT_EQ(r.energy, 0.0);
  const ShearResult folded =
      evaluateShear({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, 1.0, Curve::linear(1));
  EXPECT_TRUE(folded.rising.allFinite() && folded.falling.allFinite());
}

/// Cloth on a line: the sides along weft have no length, or that of a rounding error.
TEST(ShearTest, RoundingStoresNoEnergyInCollapsedCell) {
  const double side = 2e-3, area = side * side, rounding = 1e-13 * side;
  const auto energy = [&](double weft) {
    const Vec3 u(side, 0, 0), v(weft, 0, 0);
    return evaluateShear({Vec3::Zero(), u, v, u + v}, area, Curve::linear(10.0)).energy;
  };
  EXPECT_EQ(energy(0.0), 0.0);
  // tan γ = D/c with c² = kFolded A²/2; the energy at 90° is that of γ = π/2.
  const double sheared = energy(side), share = 1e-13 / std::sqrt(0.5 * kFolded) / (0.5 * M_PI);
  EXPECT_LT(energy(rounding), tolerance(1.01 * share * share) * sheared);
  EXPECT_NEAR(sheared, 0.5 * 10.0 * area * 0.25 * M_PI * M_PI, tolerance(1e-6) * sheared);
}

TEST(ShearTest, SlopesAreDerivativesInFlatAndCollapsedCells) {
  // Sides along weft: slanted by 1e-3, so the rounding of S is 1e-10 of it; of the length at which c counts.
  const double area = 1.0;
  for (const auto& [weft, h] : {std::pair(Vec3(1.0, 1e-3, 0.0), 1e-7), {Vec3(1e-9, 2e-9, 0.0), 1e-13}}) {
    const Vec3 u(1, 0, 0);
    const std::array<Vec3, 4> x{Vec3::Zero(), u, weft, u + weft};
    const Shear cell(x, area);
    for (int c = 0; c < 3; ++c) {
      std::array<Vec3, 4> more = x, less = x, d{};
      d.fill(Vec3::Zero());
      d[3] = Vec3::Unit(c);
      more[3][c] += h;
      less[3][c] -= h;
      const double slope = (Shear(more, area).angle() - Shear(less, area).angle()) / (2.0 * h);
      EXPECT_NEAR(cell.slope().rising[c], slope, tolerance(1e-3) * cell.slope().rising.norm() + 1e-3) << c;
      const Vec3 change = (Shear(more, area).slope().rising - Shear(less, area).slope().rising) / (2.0 * h);
      EXPECT_LT((cell.slopeChange(d).rising - change).norm(), tolerance(1e-2) * change.norm() + 1.0) << c;
    }
  }
}

/// Slopes in cells whose mean sides are short or parallel. With the sides ever shorter they would grow
/// without bound; shear.h gives the bound. Differences of slopes over 1e-6 have an error of about 1e-6 of the
/// third derivative, which the same bound limits to 1e3 here.
TEST(ShearTest, SlopesAreDerivativesAndBoundedInFoldedCells) {
  const double area = 0.8, h = 1e-6;
  for (const double length : {0.0, 0.05, 0.2, 0.39, 0.41, 0.6}) {
    for (const double angle : {0.05, 0.3, 0.8, 1.57}) {
      const Vec3 u(1.0, 0.0, 0.0),
          v = length * Vec3(std::cos(angle), 0.6 * std::sin(angle), 0.8 * std::sin(angle));
      const std::array<Vec3, 4> x{Vec3::Zero(), u, v, u + v};
      const Shear cell(x, area);
      const double bound = 3.5 * (u.norm() + v.norm()) / (2.0 * area);
      EXPECT_LT(cell.slope().rising.norm(), bound) << length << " " << angle;
      EXPECT_LT(cell.slope().falling.norm(), bound) << length << " " << angle;
      for (int c = 0; c < 3; ++c) {
        std::array<Vec3, 4> more = x, less = x, d{};
        d.fill(Vec3::Zero());
        d[1] = Vec3::Unit(c);
        more[1][c] += h;
        less[1][c] -= h;
        const double slope = (Shear(more, area).angle() - Shear(less, area).angle()) / (2.0 * h);
        EXPECT_NEAR(cell.slope().falling[c], slope, tolerance(1e-5) * bound) << length << " " << angle;
        const Vec3 change = (Shear(more, area).slope().rising - Shear(less, area).slope().rising) / (2.0 * h);
        EXPECT_LT((cell.slopeChange(d).rising - change).norm(), tolerance(1e-3)) << length << " " << angle;
      }
    }
  }
}

TEST(ShearTest, PureShearGivesItsAngle) {
  // Sides of unit length at 90° - γ: the energy is ½ G γ² A.
  const double angle = 0.3;
  const Vec3 u(1, 0, 0), v(std::sin(angle), std::cos(angle), 0);
  const ShearResult r = evaluateShear({Vec3::Zero(), u, v, u + v}, 2.0, Curve::linear(10.0));
  EXPECT_NEAR(r.energy, 0.5 * 10.0 * angle * angle * 2.0, tolerance(1e-12));
}

TEST(TripleTest, ParabolaHasItsCurvatureForAnyArms) {
  // The curvature of z = ½ κ x² is exact for three points at any distances.
  const double kappa = 3.0;
  for (const auto& [l1, l2] : {std::pair(0.1, 0.1), {0.1, 0.2}, {0.4, 0.1}}) {
    const double bent = 0.5 * (l1 + l2);
    const Triple triple{0, 1, 2, kWarp, 1 / (bent * l1), 1 / (bent * l2), 1.0, 1.0, 0.0, 1, 1};
    const Field x(
        std::vector<Vec3>{{-l1, 0, 0.5 * kappa * l1 * l1}, {0, 0, 0}, {l2, 0, 0.5 * kappa * l2 * l2}});
    const TripleResult r = evaluateTriple(triple.bent(x), Vec3::UnitZ(), triple.area, Curve::linear(2.0));
    EXPECT_NEAR(r.moment, 2.0 * kappa, tolerance(1e-12));
  }
}

TEST(ContactLawTest, PressureIsTheDerivativeAndStiffnessItsDerivative) {
  const ContactLaw law(1e-3);
  const double s = 1e-9;
  for (const double gap : {9.9e-4, 5e-4, 1e-4, 3e-5, 2.1e-5, 1.9e-5, -1e-4, -2e-3}) {
    const double pressure = -(law(gap + s).energy - law(gap - s).energy) / (2 * s);
    const double stiffness = -(law(gap + s).pressure - law(gap - s).pressure) / (2 * s);
    EXPECT_NEAR(law(gap).pressure, pressure, tolerance(1e-4) * (1.0 + pressure)) << gap;
    EXPECT_NEAR(law(gap).stiffness, stiffness, tolerance(1e-4) * (1.0 + stiffness)) << gap;
  }
  EXPECT_EQ(law(1e-3).pressure, 0.0);
  EXPECT_EQ(law(2e-3).energy, 0.0);
}

TEST(FrictionTest, ForceIsTheDerivativeAndReachesTheCoulombLimit) {
  const double epsilon = 1e-6, s = 1e-10;
  for (const double y : {1e-8, 3e-7, 9e-7, 1.1e-6, 5e-6}) {
    const double force =
        (smoothSlip(y + s, epsilon).potential - smoothSlip(y - s, epsilon).potential) / (2 * s);
    EXPECT_NEAR(smoothSlip(y, epsilon).ratio * y, force, tolerance(1e-3)) << y;
  }
  EXPECT_DOUBLE_EQ(smoothSlip(3e-6, epsilon).ratio * 3e-6, 1.0);
  EXPECT_TRUE(std::isfinite(smoothSlip(0.0, epsilon).ratio));
}

}  // namespace
}  // namespace haptic_cloth::element_test
