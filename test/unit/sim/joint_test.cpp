// Joint cost [M04] on a mesh of mixed levels with hanging nodes, pins, an obstacle, friction,
// twist, hysteresis and the probe. Criteria: the gradient is the derivative (central differences,
// 1e-5 relative); if forces follow the laws, the cost is the condensed cost's E^n, to round-off;
// both costs are zero at the same states.
#include <gtest/gtest.h>

#include <cmath>

#include "haptic_cloth/simulation.h"
#include "sim/joint_objective.h"
#include "support/derivatives.h"
#include "support/pressed_sheet.h"
#include "support/tolerance.h"

namespace haptic_cloth::joint_test {
namespace {

class JointTest : public ObjectiveTest {
 protected:
  JointTest() : joint_(objective_, mesh_, internal_, contacts_, team_) {
    unknowns_.setZero(joint_.capacity());
    joint_.begin(start_, start_, unknowns_);
    positions_ = objective_.size();
    forces_ = joint_.size() - positions_;
  }

  void grasp() {
    ASSERT_NO_FATAL_FAILURE(ObjectiveTest::grasp());
    joint_.begin(start_, start_, unknowns_);
  }

  double value(const Vector& x) {
    Vector unused = Vector::Zero(joint_.capacity());
    return joint_.evaluate(x, unused);
  }

  /// Relative error of the gradient at `x`, for `count` unknowns from `first` on.
  double errorOfGradient(const Vector& x, int first, int count, double step) {
    Vector full = x, gradient = Vector::Zero(joint_.capacity());
    const Potential potential = [&](const Eigen::VectorXd& part) {
      full.segment(first, count) = part;
      return value(full);
    };
    const Gradient derivative = [&](const Eigen::VectorXd& part) {
      full.segment(first, count) = part;
      joint_.evaluate(full, gradient);
      return Eigen::VectorXd(gradient.segment(first, count));
    };
    return gradientError(potential, derivative, x.segment(first, count), step);
  }

  JointObjective joint_;
  Vector unknowns_;
  int positions_ = 0, forces_ = 0;
};

TEST_F(JointTest, GradientIsTheDerivative) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Vector x = unknowns_;
    x.head(positions_) += 3e-5 * fixedRandom(positions_, seed);
    x.segment(positions_, forces_).array() *= 1.0 + 0.3 * fixedRandom(forces_, seed + 10).array();
    value(x);
    ASSERT_TRUE(contacts_.probeTouched(0));
    ASSERT_GT(contacts_.obstacleForce().norm(), 0.0);
    ASSERT_GT(joint_.costs().stretch, 0.0);
    ASSERT_GT(joint_.costs().bend, 0.0);
    ASSERT_GT(joint_.costs().shear, 0.0);
    EXPECT_LT(errorOfGradient(x, 0, positions_, 1e-9), tolerance(1e-5)) << seed;
    EXPECT_LT(errorOfGradient(x, positions_, forces_, 1e-4), tolerance(1e-5)) << seed;
  }
}

TEST_F(JointTest, FollowsTheLawsWhereForcesDo) {
  // With the forces of the laws at the start only Newton's law is violated, as much as in the
  // condensed cost.
  Vector gradient = Vector::Zero(objective_.capacity());
  objective_.evaluate(start_, gradient);
  const double motion = objective_.motionCost(), residual = objective_.residual(gradient);
  const double joint = value(unknowns_);
  EXPECT_GT(motion, 0.0);
  EXPECT_EQ(joint_.costs().stretch + joint_.costs().bend + joint_.costs().shear, 0.0);
  // The condensed E^n has no term for the proxy.
  const double proxy =
      gradient.segment<3>(positions_ - 3).squaredNorm() / (2.0 * objective_.couplingStiffness(0));
  EXPECT_NEAR(joint, motion + proxy, tolerance(1e-12 * joint));
  EXPECT_NEAR(joint_.residual(gradient), residual, tolerance(1e-12 * residual));
}

TEST_F(JointTest, AGraspKeepsGradientLawsAndQuadraticForm) {
  ASSERT_NO_FATAL_FAILURE(grasp());
  const std::size_t held = objective_.held().size();
  Vector gradient = Vector::Zero(joint_.capacity());
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Vector x = unknowns_;
    x.head(positions_) += 3e-5 * fixedRandom(positions_, seed);
    x.segment(positions_, forces_).array() *= 1.0 + 0.3 * fixedRandom(forces_, seed + 10).array();
    EXPECT_LT(errorOfGradient(x, 0, positions_, 1e-9), tolerance(1e-5)) << seed;
    EXPECT_LT(errorOfGradient(x, positions_, forces_, 1e-4), tolerance(1e-5)) << seed;
    joint_.evaluate(x, gradient);
    for (const HeldNode& node : objective_.held()) {
      EXPECT_EQ(gradient[node.node], 0.0) << "held nodes are no unknowns";
    }
  }
  // The condensed gradient vanishes where this one does: forces of the laws, and the same force on
  // the proxy.
  Vector condensed = Vector::Zero(objective_.capacity());
  objective_.evaluate(start_, condensed);
  double stiffness = objective_.couplingStiffness(0);
  for (const HeldNode& node : objective_.held())
    stiffness += mesh_.mass[node.node] * objective_.inertia(node.node);
  const double proxy = condensed.segment<3>(positions_ - 3).squaredNorm() / (2.0 * stiffness);
  const double joint = value(unknowns_);
  EXPECT_GT(proxy, 0.0);
  EXPECT_NEAR(joint, objective_.motionCost() + proxy, tolerance(1e-12 * joint)) << held << " held";
  // The cost is quadratic along the forces.
  Vector d = Vector::Zero(joint_.capacity());
  d.segment(positions_, forces_) = fixedRandom(forces_, 3);
  const double ahead = value(unknowns_ + d), behind = value(unknowns_ - d);
  value(unknowns_);
  const double form = joint_.along(d, -1.0).quadratic_form;
  EXPECT_NEAR(form, ahead - 2.0 * joint + behind, tolerance(1e-9 * form));
}

TEST_F(JointTest, QuadraticFormIsThatOfTheSquares) {
  // The Gauss-Newton form d · JᵀJ d equals the second difference of the cost along forces alone,
  // because the cost is quadratic there.
  Vector d = Vector::Zero(joint_.capacity()), x = unknowns_;
  d.segment(positions_, forces_) = fixedRandom(forces_, 3);
  const double middle = value(x);
  const double ahead = value(x + d), behind = value(x - d);
  value(x);
  const double form = joint_.along(d, -1.0).quadratic_form;
  EXPECT_NEAR(form, ahead - 2.0 * middle + behind, tolerance(1e-9 * form));
  d.head(positions_) = 1e-4 * fixedRandom(positions_, 4);
  EXPECT_GT(joint_.along(d, -1.0).quadratic_form, 0.0);
}

}  // namespace
}  // namespace haptic_cloth::joint_test
