// Minimizer on problems with known solutions. It must never return a point worse than its initial
// guess.
#include "solver/minimizer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "support/tolerance.h"

namespace haptic_cloth::minimizer_test {
namespace {

/// Problem Σ ½ s_k (x_k - 1)² with stiffness ratios up to 1e4, or the Rosenbrock valley.
class Problem : public Objective {
 public:
  explicit Problem(int n, bool valley = false) : n_(n), valley_(valley) {}
  int size() const override { return n_; }
  double evaluate(const Vector& x, Vector& g) override {
    x_ = x;
    if (poisoned) return std::numeric_limits<double>::quiet_NaN();
    if (valley_) {
      const double a = 1 - x[0], b = x[1] - x[0] * x[0];
      g[0] = -2 * a - 400 * x[0] * b;
      g[1] = 200 * b;
      return a * a + 100 * b * b;
    }
    double value = 0;
    for (int k = 0; k < n_; ++k) {
      g[k] = stiffness(k) * (x[k] - 1);
      value += 0.5 * stiffness(k) * (x[k] - 1) * (x[k] - 1);
    }
    return value;
  }
  Along along(const Vector& d, double slope) override {
    double c = 0;
    if (valley_) {
      const double x = x_[0], j = -2 * x;  // Gauss-Newton for the residuals 1 - x and 10 (y - x²)
      c = 2 * d[0] * d[0] + 200 * std::pow(j * d[0] + d[1], 2);
    } else {
      for (int k = 0; k < n_; ++k) c += stiffness(k) * d[k] * d[k];
    }
    return {c, std::min(newtonStep(slope, c), max_step)};
  }
  void fitPreconditioner(bool /*thoroughly*/) override {}
  void precondition(const Vector& g, Vector& z) override { z.head(n_) = g.head(n_); }
  double residual(const Vector& g) const override { return g.head(n_).norm(); }
  double stiffness(int k) const { return std::pow(10.0, 4.0 * k / (n_ - 1)); }

  bool poisoned = false;
  double max_step = 1e300;

 protected:
  Vector x_;

 private:
  int n_;
  bool valley_;
};

MinimizerReport run(Problem& problem, Vector& x, MinimizerOptions options) {
  Team team(1);
  Minimizer minimizer(options);
  minimizer.reserve(static_cast<int>(x.size()));
  return minimizer.minimize(problem, x, team);
}

/// A solve from x = 1 + distance in one unknown of stiffness 1, where the residual is the distance; at least
/// one iteration is wanted.
MinimizerReport runFrom(double distance, MinimizerOptions options) {
  Problem problem(2);
  Vector x = Vector::Ones(2);
  x[0] += distance;
  Team team(1);
  Minimizer minimizer(options);
  minimizer.reserve(2);
  Vector gradient = Vector::Zero(2);
  const double value = problem.evaluate(x, gradient);
  return minimizer.minimize(problem, x, value, gradient, team, 1);
}

// Criterion: by definition. Below a hundredth of the tolerance nothing is left to do.
TEST(MinimizerTest, MakesTheLeastIterationsWithinTheTolerance) {
  const MinimizerOptions options{Preconditioner::None, 0.1, 100, 0.0};
  for (const double distance : {0.09, 0.002}) {
    const MinimizerReport r = runFrom(distance, options);
    EXPECT_EQ(r.iterations, 1) << distance;
    EXPECT_LT(r.residual, tolerance(1e-12)) << distance;
    EXPECT_EQ(r.why, Termination::Converged) << distance;
  }
  EXPECT_EQ(runFrom(0.0005, options).iterations, 0);
  const MinimizerReport none = runFrom(0.09, {Preconditioner::None, 0.1, 0, 0.0});
  EXPECT_EQ(none.iterations, 0);
  EXPECT_EQ(none.why, Termination::Converged) << "the limit ended a solve that was done";
}

TEST(MinimizerTest, SolvesAStiffQuadratic) {
  Problem problem(30);
  Vector x = Vector::Zero(30);
  const MinimizerReport r = run(problem, x, {Preconditioner::None, 1e-8, 1000, 0.0});
  EXPECT_EQ(r.why, Termination::Converged);
  EXPECT_LT((x - Vector::Ones(30)).norm(),
            tolerance(1e-6));  // residual 1e-8 over the smallest stiffness 1, with margin
}

TEST(MinimizerTest, FollowsTheRosenbrockValley) {
  Problem problem(2, true);
  Vector x(2);
  x << -1.2, 1.0;
  const MinimizerReport r = run(problem, x, {Preconditioner::None, 1e-8, 5000, 0.0});
  EXPECT_EQ(r.why, Termination::Converged);
  EXPECT_LT((x - Vector::Ones(2)).norm(), tolerance(1e-6));
}

TEST(MinimizerTest, NeverRisesHoweverEarlyItEnds) {
  for (int limit = 0; limit < 20; ++limit) {
    Problem problem(2, true);
    Vector x(2), g(2);
    x << -1.2, 1.0;
    const double before = problem.evaluate(x, g);
    const MinimizerReport r = run(problem, x, {Preconditioner::None, 1e-8, limit, 0.0});
    EXPECT_LE(problem.evaluate(x, g), before);
    EXPECT_EQ(r.value_start, before);
    EXPECT_EQ(r.iterations, limit);
    EXPECT_EQ(r.why, Termination::IterationLimit);
  }
}

/// The quadratic form overlooks nearly half of the stiffness, as where a thread begins to stretch on the way.
class Understated : public Problem {
 public:
  Understated() : Problem(2) {}
  Along along(const Vector& d, double slope) override {
    const double form = 0.52 * Problem::along(d, slope).quadratic_form;
    return {form, newtonStep(slope, form)};
  }
};

// Criterion: a step from x to the far side of the minimum, at -0.92 x, lowers the energy by 15 %. On a line
// the secant of the slopes leads to the minimum itself.
TEST(MinimizerTest, ShortensStepsThatGoFarBeyondTheMinimum) {
  Understated problem;
  Vector x(2);
  x << 2.0, 1.0;
  const MinimizerReport r = run(problem, x, {Preconditioner::None, 1e-6, 1, 0.0});
  EXPECT_EQ(r.iterations, 1);
  EXPECT_EQ(r.evaluations, 3) << "at the start, beyond the minimum, and there";
  EXPECT_LT((x - Vector::Ones(2)).norm(), tolerance(1e-12));
}

/// A wall stops the last unknown after a hundredth of its way: a step may use up 0.9 of the distance to it.
class Walled : public Problem {
 public:
  static constexpr int kSize = 30, kStopped = kSize - 1;

  explicit Walled(bool bends) : Problem(kSize), bends_(bends) {}
  Along along(const Vector& d, double slope) override {
    Along along = Problem::along(d, slope);
    if (d[kStopped] > 0.0) along.step = std::min(along.step, room() / d[kStopped]);
    return along;
  }
  bool keepClear(Vector& d, double step) override {
    ++bent;
    if (bends_) d[kStopped] = std::min(d[kStopped], room() / step);
    return bends_;
  }
  /// Energy of the unknowns that the wall does not stop.
  double othersAt(const Vector& x) const {
    double energy = 0.0;
    for (int k = 0; k < kStopped; ++k) energy += 0.5 * stiffness(k) * std::pow(x[k] - 1.0, 2);
    return energy;
  }

  int bent = 0;

 private:
  double room() const { return 0.9 * (0.01 - x_[kStopped]); }

  bool bends_;
};

// Criterion: the wall stops all unknowns, because each step is a share of what is left before it. Around it
// the others go on to their minimum, where their energy is zero; the margins are wide, half and a hundredth
// of the energy at the start. Short solves ask for no bends.
TEST(MinimizerTest, LongSolvesBendDirectionsAroundWhatStopsThem) {
  const auto others = [](Walled& problem, int iterations) {
    Vector x = Vector::Zero(Walled::kSize);
    run(problem, x, {Preconditioner::None, 1e-8, iterations, 0.0});
    return problem.othersAt(x);
  };
  Walled brief(true), stopped(false), bent(true);
  const double start = brief.othersAt(Vector::Zero(Walled::kSize));
  others(brief, 30);
  EXPECT_EQ(brief.bent, 0);
  EXPECT_GT(others(stopped, 300), 0.5 * start);
  EXPECT_LT(others(bent, 300), 0.01 * start);
}

TEST(MinimizerTest, StopsOnTimeBudget) {
  Problem problem(30);
  Vector x = Vector::Zero(30);
  EXPECT_EQ(run(problem, x, {Preconditioner::None, 1e-300, 1000000, 1e-9}).why, Termination::TimeBudget);
}

TEST(MinimizerTest, CountsWhatWasSpentBeforeTheSolve) {
  // Two iterations are allowed. One is made, since the budget was spent before the solve began.
  Problem problem(30);
  const MinimizerOptions options{Preconditioner::None, 1e-300, 2, 0.02};
  Minimizer minimizer(options);
  minimizer.reserve(30);
  Team team(1);
  minimizer.startBudget();
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(30))
    minimizer.setOptions(options);
  Vector x = Vector::Zero(30);
  const MinimizerReport late = minimizer.minimize(problem, x, team);
  EXPECT_EQ(late.why, Termination::TimeBudget);
  EXPECT_EQ(late.iterations, 1);
}

TEST(MinimizerTest, KeepsToTheLargestStep) {
  Problem problem(2);
  problem.max_step = 1e-6;
  Vector x = Vector::Zero(2);
  const MinimizerReport r = run(problem, x, {Preconditioner::None, 1e-8, 1, 0.0});
  EXPECT_EQ(r.iterations, 1);
  // Step times -gradient, which is 1 at zero for stiffness 1.
  EXPECT_NEAR(x[0], 1e-6 * 1.0, tolerance(1e-12));
}

TEST(MinimizerTest, ReportsWhatIsNotFinite) {
  Problem problem(2);
  problem.poisoned = true;
  Vector x = Vector::Zero(2);
  EXPECT_EQ(run(problem, x, {}).why, Termination::NotFinite);
}

}  // namespace
}  // namespace haptic_cloth::minimizer_test
