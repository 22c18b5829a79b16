/// Work of a device on its coupling, in the balance of energy.
/// Criteria: a probe that touches nothing and follows its device does no work, whatever its speed, stiffness
/// and the length of steps. Elsewhere work is force times way: the force on the hand is what spring and
/// damper of the coupling pull with, up to what a solve leaves undone, its tolerance. A probe that turns
/// works by its torque.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "haptic_cloth/simulation.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::device_work_test {
namespace {

/// Weightless sheet held on all sides, and a frictionless probe.
Scene heldSheet(double stiffness, double time_step) {
  Scene scene = sheetScene(makeFabric(LinearFabric()), 17, 17, 0.1, 0.1);
  pinAllSides(scene);
  scene.gravity = Vec3::Zero();
  scene.solver.time_step = time_step;
  scene.probes[0].radius = 0.02;
  scene.probes[0].friction = 0.0;
  scene.probes[0].coupling_stiffness = stiffness;
  return scene;
}

TEST(DeviceWork, IsNoneForAProbeThatMovesFreely) {
  const Vec3 speed(0.5, 0.2, -0.1);
  for (const double time_step : {2.5e-4, 1e-3, 5e-3}) {
    for (const double stiffness : {400.0, 4000.0}) {
      Simulation simulation(heldSheet(stiffness, time_step));
      Vec3 device(-0.25, 0.0, 0.2);
      simulation.setDevice(device, speed);
      while (simulation.time() < 0.5) {
        device += time_step * speed;
        simulation.setDevice(device, speed);
        simulation.step();
        ASSERT_TRUE(simulation.probe().force.isZero(0.0));
      }
      const double step = 0.5 * stiffness * (time_step * speed).squaredNorm();
      EXPECT_NEAR(simulation.energy().dissipated, 0.0, tolerance(1e-6 * step)) << time_step;
      EXPECT_NEAR(simulation.energy().work, 0.0, tolerance(1e-6 * step)) << time_step;
    }
  }
}

TEST(DeviceWork, IsForceTimesWay) {
  constexpr double kSpeed = 0.02, kDepth = 4e-3;  // [m/s], [m]
  for (const double time_step : {5e-4, 2e-3}) {
    Scene scene = heldSheet(400.0, time_step);
    scene.air_damping = 20.0;  // so that the sheet follows without swinging
    scene.solver.minimizer.tolerance = 1e-3;
    Simulation simulation(scene);
    const double touch = scene.probes[0].radius + 1.5 * scene.cloth.fabric.thickness;
    double work = 0.0, most = 0.0;
    Vec3 device(0.0, 0.0, touch);
    simulation.setDevice(device, Vec3::Zero());
    simulation.step();
    for (const double direction : {-1.0, 1.0}) {
      const Vec3 speed(0.0, 0.0, direction * kSpeed);
      for (double way = 0.0; way < kDepth; way += kSpeed * time_step) {
        device += time_step * speed;
        simulation.setDevice(device, speed);
        simulation.step();
        work -= time_step * simulation.probe().force.dot(speed);
        most = std::max(most, std::abs(work));
      }
    }
    // The unit of the residual is the weight that the sheet would have on the earth.
    const double left = scene.solver.minimizer.tolerance * simulation.mass() * 9.81 * 2.0 * kDepth;
    EXPECT_GT(most, 100.0 * left) << "pressed";
    EXPECT_NEAR(simulation.energy().work, work, tolerance(left)) << time_step;
  }
}

TEST(DeviceWork, OfAProbeThatTurnsIsTorqueTimesTurn) {
  constexpr double kRate = 0.5, kMost = 0.15;  // [rad/s], [rad]
  for (const double time_step : {5e-4, 2e-3}) {
    Scene scene = heldSheet(4000.0, time_step);
    scene.air_damping = 20.0;  // so that the sheet follows without swinging
    scene.solver.minimizer.tolerance = 1e-3;
    scene.probes[0].radius = 5e-3;
    scene.probes[0].length = 0.05;
    Simulation simulation(scene);
    const Quat lying = lyingAlong(Vec3::UnitX());
    DeviceState device;
    device.position = Vec3(0.0, 0.0, scene.probes[0].radius + 1.5 * scene.cloth.fabric.thickness);
    double work = 0.0, turned = 0.0, most = 0.0;
    const auto turn = [&](double rate) {
      const double before = turned;
      turned += rate * time_step;
      device.orientation = Quat(Eigen::AngleAxisd(turned, Vec3::UnitY())) * lying;
      simulation.setDevice(0, device);
      simulation.step();
      work -= simulation.probe().torque.y() * (turned - before);
      most = std::max(most, std::abs(work));
    };
    turn(0.0);
    while (turned < kMost) turn(kRate);
    while (turned > 0.0) turn(-kRate);
    // The unit of the residual is the weight that the sheet would have on the earth; the ends of the capsule
    // move there and back. The way of a point is shorter than its arc by the square of a step's turn.
    const double way = kMost * scene.probes[0].length,
                 left = scene.solver.minimizer.tolerance * simulation.mass() * 9.81 * way +
                        std::pow(kRate * time_step, 2) * most;
    EXPECT_GT(most, 100.0 * left) << "pressed";
    EXPECT_NEAR(simulation.energy().work, work, tolerance(left)) << time_step;
  }
}

TEST(DeviceWork, FollowsGainsThatChangeAndProbesThatLeave) {
  Simulation simulation(heldSheet(400.0, 1e-3));
  const double touch = 0.02 + 1.5 * simulation.scene().cloth.fabric.thickness;
  simulation.setDevice(Vec3(0.0, 0.0, touch), Vec3::Zero());
  simulation.step();
  for (int k = 1; k <= 20; ++k) {
    simulation.setDevice(Vec3(0.0, 0.0, touch - 2e-4 * k), Vec3(0.0, 0.0, -0.2));
    simulation.step();
  }
  const auto pulled = [&] { return (simulation.probe().device - simulation.probe().proxy).squaredNorm(); };
  const double square = pulled(), before = simulation.energy().work;
  ASSERT_GT(square, 0.0);
  simulation.setDevice(simulation.probe().device, Vec3::Zero());
  simulation.setCoupling(0, 500.0, 0.0);
  simulation.step();
  EXPECT_NEAR(simulation.energy().work - before, 0.5 * 100.0 * square, tolerance(1e-9) * square * 500.0);
  const double stored = simulation.energy().coupling, with_spring = simulation.energy().work;
  simulation.removeDevice();
  simulation.step();
  EXPECT_NEAR(simulation.energy().work, with_spring - stored, tolerance(1e-9) * stored);
  EXPECT_EQ(simulation.energy().coupling, 0.0);
}

}  // namespace
}  // namespace haptic_cloth::device_work_test
