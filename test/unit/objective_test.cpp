// The whole incremental potential on a mesh of mixed levels with ghosts, pins, obstacles and the probe: its
// gradient is its derivative, and nothing is allocated while it is stepped. Criterion: central differences,
// 1e-5 relative; the tabulated law's and contact's kinks are finer than the step.
#include <gtest/gtest.h>

#include <cmath>

#include "haptic_cloth/simulation.h"
#include "sim/cloth_objective.h"
#include "support/derivatives.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace {

long allocations = 0;

}  // namespace

#ifndef __SANITIZE_ADDRESS__
// Counts every allocation of this program, Eigen's included: glibc's malloc under another name does the work.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace haptic_cloth {
namespace {

Scene pressedSheet() {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Fabric fabric = makeFabric(linear);
  fabric.twist_rigidity = 2e-5;
  fabric.bending[kWeft] = Loop(-256.0, 256.0, {-2e-3, 5e-4, 3e-3}, {-3e-3, -5e-4, 2e-3}, 20.0);
  Scene scene = sheetScene(fabric, 17, 17, 0.064, 0.064);
  scene.adapt.levels = 2;
  scene.air_damping = 0.5;
  pin(scene, 0, 0, 0, 3);
  Obstacle ball;
  ball.shape = Shape::Sphere;
  ball.radius = 0.02;
  ball.pose.position = Vec3(0.01, 0.0, -0.0201);
  ball.friction = 0.4;
  scene.obstacles.push_back(ball);
  scene.probe.radius = 0.008;
  scene.probe.friction = 0.3;
  return scene;
}

class ObjectiveTest : public ::testing::Test {
 protected:
  ObjectiveTest()
      : scene_(pressedSheet()),
        grid_{17, 17, 2, 0.004, 0.004},
        leaves_(mixed(grid_, scene_)),
        mesh_(leaves_, scene_.cloth.fabric.areal_density, true),
        internal_(scene_.cloth.fabric, mesh_),
        contacts_(grid_, scene_.obstacles, {5e-4, 1e-3, 1e-3, scene_.probe.radius, scene_.probe.friction}),
        team_(1),
        objective_(scene_, mesh_, internal_, contacts_, team_) {
    for (int n = 0; n < mesh_.nodes(); ++n) {
      const int p = mesh_.particle[n];
      nodes_.emplace_back((grid_.column(p) - 8) * 0.004, (grid_.row(p) - 8) * 0.004, 0.0);
    }
    const Eigen::VectorXd noise = fixedRandom(6 * mesh_.nodes(), 4);
    for (int n = 0; n < mesh_.nodes(); ++n) {
      if (n < mesh_.free) nodes_[n] += 1e-4 * noise.segment<3>(6 * n);
      velocities_.push_back(n < mesh_.free ? Vec3(0.1 * noise.segment<3>(6 * n + 3)) : Vec3::Zero());
    }
    mesh_.interpolateGhosts(nodes_);
    mesh_.interpolateGhosts(velocities_);
    internal_.setNormals(nodes_);
    const ProbeStep probe{true, Vec3(-0.01, 0.01, 0.0078), Vec3(0.1, 0, -0.2), Vec3(-0.01, 0.01, 0.0083)};
    contacts_.collect(mesh_, nodes_, 1e-3, &probe.proxy, 1e-3);
    objective_.begin(nodes_, velocities_, probe);
    start_.setZero(objective_.capacity());
    objective_.pack(nodes_, probe.proxy, start_);
  }

  static LeafMesh mixed(const Grid& grid, const Scene& scene) {
    LeafMesh leaves(grid, scene.cloth.pins, 2);
    std::vector<Cell> done;
    for (const auto& [i, j] : {std::pair(5, 9), {6, 9}, {6, 10}, {12, 3}}) {
      leaves.split(leaves.leafAt(i, j), done);
      leaves.split(leaves.leafAt(i, j), done);
    }
    return leaves;
  }

  Scene scene_;
  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  InternalEnergy internal_;
  ContactSet contacts_;
  Team team_;
  ClothObjective objective_;
  std::vector<Vec3> nodes_, velocities_;
  Vector start_;
};

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
    ASSERT_TRUE(contacts_.probeTouched());
    ASSERT_GT(contacts_.obstacleForce().norm(), 0.0);
    EXPECT_LT(gradientError(value, derivative, x, 1e-9), tolerance(1e-5)) << seed;
  }
}

TEST_F(ObjectiveTest, ProbeAndClothFeelOppositeForces) {
  // Newton's third law, to round-off: friction and pressure on the cloth and on the proxy.
  Vector gradient = Vector::Zero(objective_.capacity());
  objective_.evaluate(start_, gradient);
  Vec3 on_cloth = Vec3::Zero();
  for (int n = 0; n < mesh_.nodes(); ++n) {
    Vec3 g = Vec3::Zero();
    contacts_.addGradient(n, g);
    on_cloth -= g;
  }
  const Vec3 on_probe = -contacts_.proxyGradient();
  ASSERT_GT(on_probe.norm(), 1e-3);
  EXPECT_LT((on_cloth - contacts_.obstacleForce() + on_probe).norm(), tolerance(1e-13) * on_probe.norm());
}

TEST_F(ObjectiveTest, CurvatureIsPositiveAndBoundsTheStep) {
  Vector gradient = Vector::Zero(objective_.capacity()), d = gradient;
  objective_.evaluate(start_, gradient);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    d.head(objective_.size()) = fixedRandom(objective_.size(), seed);
    EXPECT_GT(objective_.along(d).curvature, 0.0);
  }
  // Straight at the cloth: the probe may use nine tenths of the gap of the sample that lies under it.
  d.setZero();
  d.segment<3>(objective_.size() - 3) = -Vec3::UnitZ();
  const double step = objective_.along(d).max_step;
  EXPECT_GT(step, 0.0);
  EXPECT_LT(step, 0.9 * 0.0006);  // 0.3 mm of gap over flat cloth, up to 0.1 mm of noise
}

TEST(SimulationTest, StepsWithoutAllocating) {
  Scene scene = pressedSheet();
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

}  // namespace
}  // namespace haptic_cloth
