/// Checks of the reference solutions themselves.
/// Criterion: the tables in docs/validation.md, computed with high-order shooting and finite
/// elements, to the printed digits (half a unit of the last digit, plus that of a rounded input).
#include <gtest/gtest.h>

#include <cmath>

#include "support/derivatives.h"
#include "support/reference_solutions.h"
#include "support/tolerance.h"

namespace haptic_cloth::references_test {
namespace {

TEST(HeavyElastica, MatchesTable) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  const struct {
    double lambda, tip, x, drop, curvature;
  } table[] = {{0.5, 1.1935, .999861, .015622, .124988},   {1.0, 9.4604, .991246, .123471, .496933},
               {1.5, 29.3609, .916448, .373541, 1.058595}, {2.0, 53.8650, .724425, .640631, 1.600788},
               {2.5, 71.6790, .517150, .793067, 1.991315}, {3.0, 81.6020, .367289, .863552, 2.276249},
               {4.0, 88.6021, .209201, .920113, 2.713098}, {5.0, 89.8221, .139783, .944578, 3.073398}};
  for (const auto& row : table) {
    SCOPED_TRACE(row.lambda);
    const Cantilever strip = heavyElastica(row.lambda);
    EXPECT_NEAR(strip.tip_angle / kDegree, row.tip, tolerance(6e-5));
    EXPECT_NEAR(strip.x, row.x, tolerance(6e-7));
    EXPECT_NEAR(strip.drop, row.drop, tolerance(6e-7));
    EXPECT_NEAR(strip.root_curvature, row.curvature, tolerance(6e-7));
  }
}

TEST(HeavyElastica, TendsToBeamTheory) {
  // drop / L → Γ/8 for small Γ = λ³; the next term is O(Γ³).
  const double lambda = 0.1;
  EXPECT_NEAR(heavyElastica(lambda).drop, std::pow(lambda, 3) / 8.0, tolerance(1e-9));
}

TEST(CatenarySolution, MatchesTable) {
  const struct {
    double length, sag, horizontal, largest;
  } table[] = {{1.05, .139304, .875847, 1.008518},
               {1.10, .200301, .595422, .777513},
               {1.50, .502633, .205491, .540580},
               {2.00, .796388, .114820, .513014}};
  for (const auto& row : table) {
    SCOPED_TRACE(row.length);
    const Catenary chain = catenary(row.length);
    EXPECT_NEAR(chain.sag, row.sag, tolerance(6e-7));
    EXPECT_NEAR(chain.horizontal, row.horizontal, tolerance(6e-7));
    EXPECT_NEAR(chain.largest, row.largest, tolerance(6e-7));
  }
}

TEST(CatenarySolution, ElasticMatchesTable) {
  const Catenary straight = elasticCatenary(1.0, 100.0);
  EXPECT_NEAR(straight.horizontal, 1.586167, tolerance(6e-7));
  EXPECT_NEAR(straight.largest, 1.663107, tolerance(6e-7));
  EXPECT_NEAR(straight.sag, .078190, tolerance(6e-7));
  const Catenary slack = elasticCatenary(1.2, 100.0);
  EXPECT_NEAR(slack.horizontal, .384460, tolerance(6e-7));
  EXPECT_NEAR(slack.largest, .630721, tolerance(6e-7));
  EXPECT_NEAR(slack.sag, .297014, tolerance(6e-7));
}

TEST(CatenarySolution, StiffLimitIsInextensible) {
  const Catenary stiff = elasticCatenary(1.5, 1e9);
  const Catenary rigid = catenary(1.5);
  EXPECT_NEAR(stiff.sag, rigid.sag, tolerance(1e-8));
  EXPECT_NEAR(stiff.horizontal, rigid.horizontal, tolerance(1e-8));
}

TEST(HangingExtension, LinearLawGivesClosedForm) {
  const double weight = 1.4715, length = 0.4, stiffness = 25.0;
  const double extension =
      hangingExtension(weight, length, [&](double tension) { return tension / stiffness; });
  EXPECT_NEAR(extension, weight * length * length / (2.0 * stiffness), tolerance(1e-15));
}

TEST(Derivatives, CheckerKnowsRightFromWrong) {
  const auto potential = [](const Eigen::VectorXd& x) { return std::pow(x[0], 3) + x[0] * x[1]; };
  const auto right = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(Eigen::Vector2d(3.0 * x[0] * x[0] + x[1], x[0]));
  };
  const auto wrong = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(1.01 * right(x)); };
  const Eigen::VectorXd x = fixedRandom(2, 1);
  EXPECT_LT(gradientError(potential, right, x, 1e-5), tolerance(1e-8));
  EXPECT_GT(gradientError(potential, wrong, x, 1e-5), 1e-3);
  const Eigen::VectorXd d = fixedRandom(2, 2);
  EXPECT_NEAR(differenceQuadraticForm(right, x, d, 1e-5), 6.0 * x[0] * d[0] * d[0] + 2.0 * d[0] * d[1],
              tolerance(1e-8));
}

}  // namespace
}  // namespace haptic_cloth::references_test
