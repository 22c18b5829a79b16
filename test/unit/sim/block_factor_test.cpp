// Direct solver of the preconditioner for particles that springs couple.
// Criteria: solutions against Eigen's dense factors. Both are backward stable [Higham, Accuracy and
// Stability of Numerical Algorithms, 2002, section 10.1], so they agree to the condition number, below
// kCondition here, times the rounding of sums over all unknowns.
#include "sim/block_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "support/derivatives.h"
#include "support/tolerance.h"

namespace haptic_cloth::block_factor_test {
namespace {

constexpr double kEpsilon = 0x1p-52, kCondition = 1e7;

/// Matrix of rows at places in the plane, and springs between neighbours.
struct Springs {
  Springs(int columns, int rows, double stiffness) {
    const int count = columns * rows;
    dense = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    for (int n = 0; n < count; ++n) {
      const Eigen::VectorXd r = fixedRandom(3, n);
      const Block own = isotropic(1.0) + square(Vec3(r[0], r[1], r[2]));
      EXPECT_EQ(factor.addRow(own, Vec3(n % columns, n / columns, 0.0)), n);
      dense.block<3, 3>(3 * n, 3 * n) += matrix(own);
    }
    for (int n = 0; n < count; ++n) {
      // A point against a triangle: four rows, whose weights have the sum 0.
      const int right = n + 1, above = n + columns, across = n + columns + 1;
      if (n % columns + 1 == columns || across >= count) continue;
      const Eigen::VectorXd r = fixedRandom(3, 1000 + n);
      add(stiffness * square(Vec3(r[0], r[1], r[2]).normalized()),
          {{n, 1.0}, {right, -0.5}, {above, -0.3}, {across, -0.2}});
    }
  }
  void add(const Block& stiffness, const std::vector<BlockFactor::End>& ends) {
    factor.addSpring(stiffness, ends);
    for (const auto& a : ends) {
      for (const auto& b : ends)
        dense.block<3, 3>(3 * a.row, 3 * b.row) += a.weight * b.weight * matrix(stiffness);
    }
  }
  void expectSolved() {
    ASSERT_TRUE(factor.factor());
    const int count = factor.rows();
    const Eigen::VectorXd right = fixedRandom(3 * count, 7);
    std::vector<Vec3> values(count);
    for (int n = 0; n < count; ++n) values[n] = right.segment<3>(3 * n);
    factor.solve(values);
    const Eigen::VectorXd exact = dense.llt().solve(right);
    for (int n = 0; n < count; ++n) {
      EXPECT_LT((values[n] - exact.segment<3>(3 * n)).norm(),
                tolerance(3 * count * kEpsilon * kCondition) * exact.norm())
          << n;
    }
  }
  BlockFactor factor;
  Eigen::MatrixXd dense;
};

TEST(BlockFactorTest, SolvesAsADenseFactor) {
  for (const double stiffness : {1e-3, 1.0, 1e5}) {
    for (const int side : {1, 2, 3, 7, 12}) Springs(side, side + 1, stiffness).expectSolved();
  }
}

TEST(BlockFactorTest, SolvesRowsThatNothingCouples) {
  Springs apart(4, 1, 1.0);  // one row of points has no triangles
  apart.expectSolved();
  Springs far(5, 5, 1e4);
  far.add(1e4 * square(Vec3::UnitX()),
          {{0, 1.0}, {24, -1.0}});  // layers that meet are far apart in the cloth
  far.expectSolved();
}

TEST(BlockFactorTest, CanBeUsedAgain) {
  Springs springs(6, 5, 10.0);
  springs.expectSolved();
  springs.factor.clear();
  EXPECT_EQ(springs.factor.rows(), 0);
  EXPECT_TRUE(springs.factor.factor()) << "nothing is definite";
  springs.factor.addRow(isotropic(2.0), Vec3::Zero());
  springs.dense = 2.0 * Eigen::Matrix3d::Identity();
  springs.expectSolved();
}

TEST(BlockFactorTest, RefusesWhatIsNotDefinite) {
  BlockFactor factor;
  factor.addRow(isotropic(1.0), Vec3::Zero());
  factor.addRow(isotropic(-1.0), Vec3::UnitX());
  EXPECT_FALSE(factor.factor());
  factor.clear();
  factor.addRow(isotropic(NAN), Vec3::Zero());
  EXPECT_FALSE(factor.factor());
}

/// Two springs in series push two rows together; both may move as one. [Σ F = Σ own · x]
TEST(BlockFactorTest, StiffSpringsLetRowsMoveTogether) {
  BlockFactor factor;
  for (int n = 0; n < 3; ++n) factor.addRow(isotropic(1.0), n * Vec3::UnitX());
  const double stiffness = 1e9;
  for (const int n : {0, 1}) factor.addSpring(isotropic(stiffness), {{n, 1.0}, {n + 1, -1.0}});
  ASSERT_TRUE(factor.factor());
  std::vector<Vec3> values{Vec3::UnitZ(), Vec3::Zero(), Vec3::Zero()};
  factor.solve(values);
  for (const Vec3& value : values) {
    // Apart by less than the force over the stiffness; rounding is amplified by stiffness/own.
    EXPECT_LT((value - Vec3::UnitZ() / 3.0).norm(), tolerance(1.0 / stiffness + 10.0 * kEpsilon * stiffness));
  }
}

}  // namespace
}  // namespace haptic_cloth::block_factor_test
