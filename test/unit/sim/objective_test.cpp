// Incremental potential on a mesh of mixed levels with hanging nodes, pins, obstacles and the
// probe: its gradient is its derivative, and stepping allocates nothing. Criterion: central
// differences, 1e-5 relative; the kinks of the tabulated law and of contact are finer than the
// step.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <string>
#include <tuple>

#include "haptic_cloth/simulation.h"
#include "support/derivatives.h"
#include "support/pressed_sheet.h"
#include "support/tolerance.h"

namespace {

long allocations = 0;

}  // namespace

#ifndef __SANITIZE_ADDRESS__
// Counts every allocation of this program, Eigen's and aligned ones included; glibc does the work under
// other names.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace haptic_cloth::objective_test {
namespace {

TEST_F(ObjectiveTest, GradientIsTheDerivative) {
  ASSERT_GT(mesh_.ghosts.size(), 10u);
  const int n = objective_.size();
  Vector gradient = Vector::Zero(n);
  const Potential value = [&](const Eigen::VectorXd& x) {
    Vector unused = Vector::Zero(n);
    return objective_.evaluate(x, unused);
  };
  const Gradient derivative = [&](const Eigen::VectorXd& x) {
    objective_.evaluate(x, gradient);
    return Eigen::VectorXd(gradient);
  };
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd x = start_.head(n) + 3e-5 * fixedRandom(n, seed);
    value(x);
    ASSERT_TRUE(contacts_.probeTouched(0));
    ASSERT_GT(contacts_.obstacleForce().norm(), 0.0);
    EXPECT_LT(gradientError(value, derivative, x, 1e-9), tolerance(1e-5)) << seed;
  }
}

/// The same with a capsule whose turn is solved for.
class TurningTest : public ObjectiveTest {
 protected:
  TurningTest() : ObjectiveTest(0.02), turn_(objective_.size() - 3) {}

  /// Relative error of the gradient by the turn alone and by all unknowns, beside a turn by 0.2 rad about the
  /// capsule's axis.
  void expectDerivative(unsigned seed) {
    const int n = objective_.size();
    Vector gradient = Vector::Zero(n);
    Eigen::VectorXd x = start_.head(n) + 3e-5 * fixedRandom(n, seed);
    x.segment<3>(turn_) += Vec3(0.2, 0.003, 0.002);
    const auto at = [&](const Eigen::VectorXd& turn) {
      Eigen::VectorXd turned = x;
      turned.segment<3>(turn_) = turn;
      return objective_.evaluate(turned, gradient);
    };
    const Gradient by_turn = [&](const Eigen::VectorXd& turn) {
      at(turn);
      return Eigen::VectorXd(gradient.segment<3>(turn_));
    };
    const Potential value = [&](const Eigen::VectorXd& all) { return objective_.evaluate(all, gradient); };
    const Gradient by_all = [&](const Eigen::VectorXd& all) {
      objective_.evaluate(all, gradient);
      return Eigen::VectorXd(gradient);
    };
    EXPECT_LT(gradientError(at, by_turn, x.segment<3>(turn_), 1e-7), tolerance(1e-5)) << seed;
    EXPECT_LT(gradientError(value, by_all, x, 1e-9), tolerance(1e-5)) << seed;
  }

  const int turn_;  ///< first unknown of the turn
};

TEST_F(TurningTest, GradientIsTheDerivative) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    ASSERT_NO_FATAL_FAILURE(expectDerivative(seed));
    ASSERT_TRUE(contacts_.probeTouched(0));
    ASSERT_GT(objective_.torque(0).norm(), 1e-3 * objective_.force(0).norm());
  }
}

TEST_F(TurningTest, GradientIsTheDerivativeOfWhatItHolds) {
  ASSERT_NO_FATAL_FAILURE(grasp());
  for (unsigned seed = 1; seed <= 5; ++seed) expectDerivative(seed);
}

// Turned by δ about an axis, the capsule changes Φ's gradient by H δ. Left out of H⁺ are the change of the
// normals, and of arms under load: pressure over the radius and times the arm, against the stiffness of
// contact times the arm squared, here below 1 : 20. Friction counts at most as at the beginning.
TEST_F(TurningTest, QuadraticFormIsThatOfTheTurn) {
  constexpr double kTurn = 1e-6;  // [rad]
  const int n = objective_.size();
  Vector gradient = Vector::Zero(objective_.capacity()), d = gradient;
  for (int axis = 0; axis < 3; ++axis) {
    d.setZero();
    d[turn_ + axis] = kTurn;
    const auto slope = [&](double factor) {
      const Vector there = start_ + factor * d;
      objective_.evaluate(there, gradient);
      return gradient.head(n).dot(d.head(n));
    };
    const double change = 0.5 * (slope(1.0) - slope(-1.0));
    objective_.evaluate(start_, gradient);
    ASSERT_GT(change, 2.0 * kTurn * kTurn * objective_.turnStiffness(0)) << "contact resists, too";
    EXPECT_NEAR(objective_.along(d, -1.0).quadratic_form, change, tolerance(0.05) * change) << axis;
  }
}

TEST_F(ObjectiveTest, ProbeAndClothFeelOppositeForces) {
  // Newton's third law to round-off: friction and pressure on the cloth and on the proxy.
  Vector gradient = Vector::Zero(objective_.capacity());
  objective_.evaluate(start_, gradient);
  Field by_contact;
  by_contact.clear(mesh_.nodes());
  contacts_.addGradient(0, mesh_.nodes(), by_contact);
  Vec3 on_cloth = Vec3::Zero();
  for (int n = 0; n < mesh_.nodes(); ++n) on_cloth -= by_contact[n];
  const Vec3 on_probe = -contacts_.proxyGradient(0);
  ASSERT_GT(on_probe.norm(), 1e-3);
  EXPECT_LT((on_cloth - contacts_.obstacleForce() + on_probe).norm(), tolerance(1e-13) * on_probe.norm());
}

TEST_F(ObjectiveTest, QuadraticFormIsPositiveAndBoundsTheStep) {
  Vector gradient = Vector::Zero(objective_.capacity()), d = gradient;
  objective_.evaluate(start_, gradient);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    d.head(objective_.size()) = fixedRandom(objective_.size(), seed);
    EXPECT_GT(objective_.along(d, -1.0).quadratic_form, 0.0);
  }
  // Straight at the cloth the probe may use nine tenths of the gap of the sample below it.
  d.setZero();
  d.segment<3>(objective_.size() - 3) = -Vec3::UnitZ();
  const double step = objective_.along(d, -1e300).step;
  EXPECT_GT(step, 0.0);
  EXPECT_LT(step, 0.9 * 0.0006);  // 0.3 mm of gap above flat cloth, and up to 0.1 mm of noise
}

struct Solver {
  const char* name;
  Cost cost;
  Preconditioner preconditioner;
};

class SimulationTest : public ::testing::TestWithParam<Solver> {};

TEST_P(SimulationTest, StepsWithoutAllocating) {
  Scene scene = pressedSheet();
  scene.solver.cost = GetParam().cost;
  scene.solver.minimizer.preconditioner = GetParam().preconditioner;
  scene.cloth.pose.position.z() = 0.001;
  scene.adapt.strategy = Strategy::Amrc;
  scene.adapt.minimum_age = 3;
  Simulation simulation(scene);
  const auto press = [&](int from, int to) {
    int changes = 0;
    for (int k = from; k < to; ++k) {
      const double depth = 0.004 * std::sin(0.05 * k);
      simulation.setDevice(Vec3(-0.015 + 1e-4 * (k % 100), 0, 0.0095 - depth), Vec3::Zero());
      const StepReport r = simulation.step();
      changes += r.refined + r.coarsened;
    }
    return changes;
  };
  press(0, 150);
  const long before = allocations;
  const int changes = press(150, 300);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(changes, 0);
}

INSTANTIATE_TEST_SUITE_P(Solvers, SimulationTest,
                         testing::Values(Solver{"condensed", Cost::Condensed, Preconditioner::Multilevel},
                                         Solver{"jacobi", Cost::Condensed, Preconditioner::Jacobi},
                                         Solver{"joint", Cost::Joint, Preconditioner::Multilevel}),
                         [](const auto& info) { return info.param.name; });

TEST(Simulation, BudgetCountsFromTheStepsStart) {
  // A budget that was spent before the step must not count. Only then does the solve make more than
  // the one iteration that is always allowed.
  Scene scene = pressedSheet();
  scene.solver.minimizer.tolerance = 1e-9;
  scene.solver.minimizer.max_iterations = 5;
  scene.solver.minimizer.time_budget = 0.2;
  Simulation simulation(scene);
  const auto built = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - built < std::chrono::milliseconds(250)) simulation.maxSpeed();
  EXPECT_EQ(simulation.step().minimizer.iterations, 5);
}

class Drape : public ::testing::TestWithParam<std::tuple<StartMesh, Integrator>> {};

TEST_P(Drape, FallsOverABoxWithoutAllocating) {
  // Covers the time from the first touch on: contacts grow from none to all, and hysteresis is
  // handed over at each change of the mesh.
  Scene scene = boxDrape(41);
  std::tie(scene.adapt.start, scene.solver.integrator) = GetParam();
  scene.cloth.fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml");
  Simulation simulation(scene);
  for (int k = 0; k < 5; ++k) simulation.step();
  const long before = allocations;
  int changes = 0;
  for (int k = 0; k < 200; ++k) {
    simulation.setDevice(Vec3(1e-4 * k, 0.0, 0.02 - 1e-4 * k), Vec3::Zero());
    if (k == 150) simulation.removeDevice();
    const StepReport r = simulation.step();
    changes += r.refined + r.coarsened;
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(changes, 100);
  EXPECT_GT(simulation.supportForce().norm(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Starts, Drape,
                         testing::Combine(testing::Values(StartMesh::Finest, StartMesh::Coarsest),
                                          testing::Values(Integrator::Euler, Integrator::Bdf2)),
                         [](const auto& info) {
                           const bool finest = std::get<0>(info.param) == StartMesh::Finest;
                           const bool second = std::get<1>(info.param) == Integrator::Bdf2;
                           return std::string(finest ? "finest" : "coarsest") + (second ? "_bdf2" : "");
                         });

/// Pairs of layers come and go, so their lists cannot be reserved. They at least double where they grow:
/// from no pairs to all, which are less than 2^14, each of 9 lists allocates 14 times at most.
TEST(Fold, StepsWithoutAllocating) {
  Simulation simulation(foldedSheet(33));
  for (int k = 0; k < 5; ++k) simulation.step();
  const long before = allocations;
  for (int k = 0; k < 150; ++k) simulation.step();
  EXPECT_LE(allocations - before, 9 * 14) << "while it folds";
  std::cout << "  " << allocations - before << " allocations while it folds\n";
  const long folded = allocations;
  int pressed = 0;
  for (int k = 0; k < 100; ++k) pressed += simulation.step().self_contacts > 20 ? 1 : 0;
  EXPECT_EQ(allocations, folded);
  EXPECT_EQ(pressed, 100);
}

}  // namespace
}  // namespace haptic_cloth::objective_test
