/// Torque on a probe about its proxy, from a solve.
/// Criteria: a force at a known place gives a torque by its lever arm; a sphere without friction
/// has none; cloth that hangs from a probe turns it by its weight at its mass centre.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::probe_torque_test {
namespace {

constexpr double kGravity = 9.81;

/// Runs for `time` [s]; the device moves from its last position with `velocity` [m/s].
void move(Simulation& simulation, Vec3& device, const Vec3& velocity, double time,
          const Quat& orientation = Quat::Identity()) {
  const double h = simulation.scene().solver.time_step;
  for (double t = 0.5 * h; t < time; t += h) {
    device += h * velocity;
    simulation.setDevice(0, {device, velocity, orientation});
    simulation.step();
  }
}

class TorqueOfAStrip : public testing::TestWithParam<Strategy> {};

/// A strip of 40 mm presses on a longer capsule across it, whose origin is 15 mm beside the middle
/// of the strip. By symmetry the force acts in the middle of the strip.
TEST_P(TorqueOfAStrip, IsTheForceAtTheStripsMiddle) {
  constexpr double kRadius = CapsuleOnStrip::kRadius, kAside = 0.015;
  Simulation simulation(capsuleOnStrip(GetParam()));
  const Quat lying = lyingAlong(Vec3::UnitY());
  Vec3 device(0.0, kAside, kRadius + 0.002);
  move(simulation, device, Vec3(0.0, 0.0, -0.1), 0.25, lying);
  move(simulation, device, Vec3::Zero(), 0.5, lying);
  const ProbeReport report = simulation.probe();
  ASSERT_GT(report.force.z(), 0.3);
  const Vec3 arm(0.0, -report.proxy.y(), 0.0);
  const Vec3 expected = arm.cross(report.force);
  record({"strip under a cylinder, off its middle", "torque [N m]", name(GetParam()), kAside,
          report.torque.x(), expected.x(), expected.x()});
  EXPECT_NEAR(report.proxy.y(), kAside, 1e-3);
  // The pressure is even across the strip as far as the solve has converged: 1e-3.
  EXPECT_LT((report.torque - expected).norm(), tolerance(1e-3 * expected.norm()))
      << report.torque.transpose() << " for " << expected.transpose();
}

INSTANTIATE_TEST_SUITE_P(Strategies, TorqueOfAStrip, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

/// Cloth on a table, and a sphere that presses on it and slides.
Scene tableScene(double friction) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.1, 0.1);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.cloth.pose.position.z() = 3e-4;
  Obstacle floor;
  floor.shape = Shape::Box;
  floor.size = Vec3(0.5, 0.5, 0.1);
  floor.pose.position.z() = -0.05;
  floor.friction = 1.0;
  scene.obstacles.push_back(floor);
  scene.probes[0].friction = friction;
  return scene;
}

ProbeReport slide(double friction) {
  const Scene scene = tableScene(friction);
  Simulation simulation(scene);
  Vec3 device(0.0, 0.0, scene.probes[0].radius + 0.003);
  move(simulation, device, Vec3(0.0, 0.0, -0.1), 0.06);
  move(simulation, device, Vec3(0.1, 0.0, 0.0), 0.1);
  return simulation.probe();
}

/// Only rounding: 1e-16 of force times radius for each of some hundred samples.
TEST(TorqueOfASphere, WithoutFrictionIsZero) {
  const ProbeReport report = slide(0.0);
  ASSERT_GT(report.force.z(), 0.3);
  EXPECT_LT(report.torque.norm(), tolerance(1e-13 * report.force.norm() * 0.01));
}

/// The cloth drags at its middle plane, between the sphere's radius and a thickness more from its
/// centre. On the table nearly all of it presses from straight below, within the angle φ of the
/// patch, cos φ = 1 - 2 t/R.
TEST(TorqueOfASphere, WithFrictionIsTheDragAtTheRadius) {
  const ProbeReport report = slide(0.3);
  const Scene scene = tableScene(0.3);
  const double radius = scene.probes[0].radius, thickness = scene.cloth.fabric.thickness;
  const Vec3 drag(report.force.x(), report.force.y(), 0.0);
  ASSERT_GT(drag.norm(), 0.1);
  const Vec3 expected = Vec3(0.0, 0.0, -radius).cross(drag);
  const double ratio = report.torque.dot(expected) / expected.squaredNorm();
  std::printf("torque over drag times radius: %.4f\n", ratio);
  EXPECT_GT(ratio, 1.0 - 2.0 * thickness / radius);
  EXPECT_LT(ratio, 1.0 + 3.0 * thickness / radius);
  EXPECT_LT((report.torque - ratio * expected).norm(), tolerance(0.05 * expected.norm()));
}

/// Sheet at rest in the air, hanging from the capsule that grasped it near its corner.
TEST(TorqueOfAGrasp, IsTheWeightAtTheMassCentre) {
  Scene scene = tableScene(0.3);
  setStrategy(scene, Strategy::Finest, 0);
  scene.air_damping = 5.0;
  scene.probes[0].length = 0.03;
  Simulation simulation(scene);
  const double radius = scene.probes[0].radius;
  const Quat lying = lyingAlong(Vec3::UnitY());
  Vec3 device = particle(simulation, 2, 6) + Vec3(0.0, 0.0, radius + 0.002);
  move(simulation, device, Vec3(0.0, 0.0, -0.1), 0.025, lying);
  simulation.setGrasp(0, true);
  move(simulation, device, Vec3(0.0, 0.0, 0.3), 0.7, lying);
  move(simulation, device, Vec3::Zero(), 3.0, lying);
  const ProbeReport report = simulation.probe();
  ASSERT_TRUE(report.grasps);
  std::vector<Vec3> positions;
  simulation.positions(positions);
  Vec3 centre = Vec3::Zero();
  double shares = 0.0;
  // Half a cell at a side, a quarter in a corner.
  for (std::size_t p = 0; p < positions.size(); ++p) {
    const int i = static_cast<int>(p) % 33, j = static_cast<int>(p) / 33;
    const double share = (i % 32 == 0 ? 0.5 : 1.0) * (j % 32 == 0 ? 0.5 : 1.0);
    centre += share * positions[p];
    shares += share;
  }
  centre /= shares;
  const Vec3 weight(0.0, 0.0, -simulation.mass() * kGravity);
  const Vec3 expected = (centre - report.proxy).cross(weight);
  record({"sheet that hangs from a grasp", "torque [N m]", "finest", 0.0, report.torque.norm(),
          expected.norm(), expected.norm()});
  // Same tolerance as for the weight (Grasp.LiftsTheClothAndFeelsItsWeight): it still swings a
  // little.
  EXPECT_LT((report.torque - expected).norm(), tolerance(0.02 * expected.norm()))
      << report.torque.transpose() << " for " << expected.transpose();
}

}  // namespace
}  // namespace haptic_cloth::probe_torque_test
