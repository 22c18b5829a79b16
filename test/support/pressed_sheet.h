/// Sheet that uses every term of the potential, for tests of objectives.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "sim/cloth_objective.h"
#include "support/derivatives.h"
#include "support/scenes.h"

namespace haptic_cloth {

/// Scene with 17 × 17 particles, a pinned edge, a ball below, a probe above, twist, and hysteresis
/// in weft bending.
inline Scene pressedSheet() {
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
  scene.probes[0].radius = 0.008;
  scene.probes[0].friction = 0.3;
  return scene;
}

/// Fixture: the sheet on a mesh of mixed levels with hanging nodes and noise on all positions,
/// within a step.
class ObjectiveTest : public ::testing::Test {
 protected:
  /// @param length of the probe, a capsule along x whose turn is solved for; 0: a sphere [m]
  explicit ObjectiveTest(double length = 0.0)
      : scene_(pressedSheet()),
        grid_{17, 17, 2, 0.004, 0.004},
        leaves_(mixed(grid_, scene_)),
        mesh_(leaves_, scene_.cloth.fabric.areal_density),
        internal_(scene_.cloth.fabric, mesh_),
        team_(1),
        contacts_(grid_, scene_.obstacles, withLength(length), {5e-4, 1e-3, 1e-3}, team_),
        integrator_(Integrator::Bdf2, scene_.solver.time_step, scene_.air_damping, grid_),
        objective_(scene_, mesh_, integrator_, internal_, contacts_, team_) {
    for (Field* field : {&nodes_, &velocities_, &still_}) field->clear(mesh_.nodes());
    for (int n = 0; n < mesh_.nodes(); ++n) {
      const int p = mesh_.particle[n];
      nodes_.set(n, Vec3((grid_.column(p) - 8) * 0.004, (grid_.row(p) - 8) * 0.004, 0.0));
    }
    const Eigen::VectorXd noise = fixedRandom(6 * mesh_.nodes(), 4);
    for (int n = 0; n < mesh_.free; ++n) {
      nodes_.add(n, 1e-4 * noise.segment<3>(6 * n));
      velocities_.set(n, 0.1 * noise.segment<3>(6 * n + 3));
    }
    mesh_.interpolateGhosts(nodes_);
    mesh_.interpolateGhosts(velocities_);
    startStep();
    internal_.setNormals(nodes_);
    ProbeStep probe;
    probe.present = true;
    probe.turns = length > 0.0;
    probe.device = Vec3(-0.01, 0.01, 0.0078);
    probe.device_velocity = Vec3(0.1, 0, -0.2);
    probe.proxy = Vec3(-0.01, 0.01, 0.0083);
    if (probe.turns) {
      probe.orientation = lyingAlong(Vec3::UnitX());
      probe.device_turn = Vec3(0.02, -0.01, 0.03);
      probe.device_orientation = rotationBy(Vec3(0.04, 0.03, -0.05)) * probe.orientation;
    }
    contacts_.startProbe(0, probe.proxy, probe.orientation, probe.orientation);
    contacts_.collectProbes(mesh_, nodes_, std::vector<double>(mesh_.nodes(), 1e-3), still_, {{0, 1e-3}});
    contacts_.collectObstacles(mesh_, nodes_, std::vector<double>(mesh_.nodes(), 1e-3), still_);
    objective_.begin(nodes_, velocities_, {probe});
    start_.setZero(objective_.capacity());
    objective_.pack(nodes_, start_);
  }

  const std::vector<ProbeOptions>& withLength(double length) {
    scene_.probes[0].length = length;
    return scene_.probes;
  }

  /// Grasps some free nodes under the probe.
  void grasp() {
    std::vector<HeldNode> held;
    const Vec3 proxy = objective_.probeSteps()[0].proxy;
    for (int n = 0; n < mesh_.free; ++n) {
      const Vec3 offset = nodes_[n] - proxy;
      if (offset.norm() < 0.011) held.push_back({n, 0, offset, offset});
    }
    ASSERT_GE(held.size(), 5u);
    objective_.begin(nodes_, velocities_, objective_.probeSteps(), held);
  }

  /// Starts a step after one that left noise, in which every third node may touch something.
  void startStep() {
    Field rest;
    rest.clear(mesh_.nodes());
    ParticleState state;
    std::vector<char> touching;
    const Eigen::VectorXd noise = fixedRandom(6 * grid_.particles(), 9);
    for (int p = 0; p < grid_.particles(); ++p) {
      state.moved.push_back(1e-4 * noise.segment<3>(6 * p));
      state.gained.push_back(0.1 * noise.segment<3>(6 * p + 3));
    }
    for (int n = 0; n < mesh_.nodes(); ++n) touching.push_back(mesh_.particle[n] % 3 == 0 ? 1 : 0);
    integrator_.gather(mesh_, state);
    integrator_.finish(mesh_, nodes_, nodes_, rest);
    integrator_.begin(scene_.solver.time_step);
    integrator_.gather(mesh_, state);
    integrator_.expectJumps(touching);
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
  Team team_;
  ContactSet contacts_;
  TimeIntegrator integrator_;
  ClothObjective objective_;
  Field nodes_, velocities_, still_;
  Vector start_;
};

}  // namespace haptic_cloth
