/// Sleep of cloth at rest.
/// Criteria: the cloth ends where it would without sleep, within what sleep may hide. A particle
/// sleeps after 50 steps slower than v = 0.3 mm/s, so accelerations below v/(50 h) = 0.6 mm/s² =
/// 6e-4 g are lost. Sleeping cloth takes no iteration; when touched, it responds as if it had never
/// slept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/cloth_world.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::rest_test {
namespace {

/// Suiting held by two sides; it sags, and its hysteresis brings it to rest.
Scene sagging(double sleep_speed) {
  Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"), 33, 33,
                           0.16, 0.16);
  pin(scene, 0, 0, 0, 32);
  pin(scene, 32, 32, 0, 32);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.air_damping = 5.0;
  scene.probes[0].radius = 0.01;
  scene.solver.sleep_speed = sleep_speed;
  return scene;
}

void run(Simulation& simulation, double seconds) {
  for (const double end = simulation.time() + seconds; simulation.time() < end;) simulation.step();
}

/// Lowers the probe in the middle within 0.1 s to 4 mm below the hanging cloth. @return force on it
/// [N]
Vec3 press(Simulation& simulation) {
  const double top = particle(simulation, 16, 16).z() + 0.0115;
  for (int step = 0; step < 150; ++step) {
    const double down = std::min(1.0, step / 100.0);
    simulation.setDevice(Vec3(0.0, 0.0, top - 0.0155 * down), Vec3(0.0, 0.0, step < 100 ? -0.155 : 0.0));
    simulation.step();
  }
  return simulation.probe().force;
}

double rms(const Simulation& a, const Simulation& b) {
  std::vector<Vec3> x, y;
  a.positions(x);
  b.positions(y);
  double sum = 0.0;
  for (std::size_t p = 0; p < x.size(); ++p) sum += (x[p] - y[p]).squaredNorm();
  return std::sqrt(sum / x.size());
}

TEST(Rest, SleepsWhereItWouldRestAndWakesWhenTouched) {
  Simulation awake(sagging(0.0)), sleeper(sagging(3e-4));
  run(awake, 2.0);
  run(sleeper, 2.0);
  EXPECT_GT(-particle(awake, 16, 16).z(), 0.005) << "nothing sagged";
  EXPECT_EQ(sleeper.maxSpeed(), 0.0);
  record({"sleep", "rms distance from the shape without sleep [m]", "amrc", 0.0, rms(awake, sleeper), 0.0,
          0.16});
  EXPECT_LT(rms(awake, sleeper), tolerance(1e-3 * 0.16));

  const StepReport asleep = sleeper.step();
  EXPECT_EQ(asleep.minimizer.iterations + asleep.minimizer.evaluations, 0);
  EXPECT_EQ(asleep.awake_particles, 0);

  const Vec3 expected = press(awake), felt = press(sleeper);
  EXPECT_GT(expected.z(), 0.02);
  record({"sleep", "force on a probe that wakes it [N]", "amrc", 0.0, felt.z(), expected.z(), expected.z()});
  EXPECT_NEAR(felt.z(), expected.z(), tolerance(0.03 * expected.z()));
}

/// Waits with a device that stands still in the cloth until steps are skipped.
void pressAndSleep(Simulation& simulation, Vec3& device) {
  run(simulation, 0.5);
  press(simulation);
  device = simulation.probe().device;
  StepReport report;
  for (int step = 0; step < 2000; ++step) {
    simulation.setDevice(device, Vec3::Zero());
    report = simulation.step();
  }
  ASSERT_EQ(report.awake_particles + report.minimizer.evaluations, 0);
}

TEST(Rest, ADeviceThatGoesAndComesBackWithinAStepLeavesNoDent) {
  // The returning probe is a new one: it starts inside the cloth and touches nothing, so the cloth
  // must rise from 12 mm below its position without a probe. Hysteresis keeps 1.1 mm of that.
  Simulation simulation(sagging(3e-4));
  run(simulation, 0.5);
  const double hanging = particle(simulation, 16, 16).z();
  Vec3 device;
  pressAndSleep(simulation, device);
  ASSERT_LT(particle(simulation, 16, 16).z(), hanging - 0.010);
  simulation.removeDevice();
  simulation.setDevice(device, Vec3::Zero());
  for (int step = 0; step < 500; ++step) {
    simulation.setDevice(device, Vec3::Zero());
    simulation.step();
  }
  EXPECT_FALSE(simulation.probe().contact);
  EXPECT_GT(particle(simulation, 16, 16).z(), hanging - 0.002);
}

TEST(Rest, ADeviceThatGoesIsNoticed) {
  Simulation simulation(sagging(3e-4));
  run(simulation, 0.5);
  const double hanging = particle(simulation, 16, 16).z();
  Vec3 device;
  pressAndSleep(simulation, device);
  simulation.removeDevice();
  run(simulation, 0.5);
  EXPECT_GT(particle(simulation, 16, 16).z(), hanging - 0.001);
  const Vec3 up = particle(simulation, 16, 16) + Vec3(0.0, 0.0, 0.0115);
  for (int step = 0; step < 150; ++step) {
    simulation.setDevice(up - 4e-5 * std::min(step, 100) * Vec3::UnitZ(), Vec3::Zero());
    simulation.step();
  }
  EXPECT_GT(simulation.probe().force.z(), 0.01);
}

TEST(Rest, ResetFromSleepIsANewStart) {
  Simulation simulation(sagging(3e-4)), fresh(sagging(3e-4));
  Vec3 device;
  pressAndSleep(simulation, device);
  simulation.reset();
  run(simulation, 0.1);
  run(fresh, 0.1);
  EXPECT_EQ(simulation.stateHash(), fresh.stateHash());
}

TEST(Rest, EnergyIsThatOfAllElementsHoweverASolveEnds) {
  // While some particles sleep, a solve covers only the others. Reports and energy guard cover all:
  // they agree to round-off with what the elements store at the reported positions, also if time
  // runs out.
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sagging(3e-4);
  scene.cloth.fabric = makeFabric(linear);
  setStrategy(scene, Strategy::Coarsest, 1);
  scene.solver.minimizer.time_budget = 1e-9;  // one iteration per step
  ClothWorld world(scene);
  for (int step = 0; step < 4000 && (step == 0 || world.cloth().maxSpeed() > 0.0); ++step) world.step();
  ASSERT_EQ(world.cloth().maxSpeed(), 0.0);
  int cut_short = 0;
  for (int step = 0; step < 100; ++step) {
    world.setDevice(0, {Vec3(-0.06, 0.05, 0.01 - 2e-4 * step), Vec3(0.0, 0.0, -0.2)});
    const StepReport report = world.step();
    const bool partly = report.awake_particles > 0 && report.awake_particles < world.cloth().mesh().free;
    if (!partly || report.minimizer.why != Termination::TimeBudget) continue;
    ++cut_short;
    const EnergyReport energy = world.energy();
    const InternalEnergy::Energy stored = world.cloth().internal().stored(world.cloth().nodes());
    const double sum = stored.stretch + stored.bend + stored.shear;
    EXPECT_NEAR(energy.stretch + energy.bend + energy.shear, sum, tolerance(1e-9) * sum) << step;
  }
  EXPECT_GT(cut_short, 0);
}

TEST(Rest, ACreepingProbeIsFelt) {
  // At 0.015 mm/s no particle is ever faster than the sleep speed. A sleeping particle hides a
  // change of force of three times the tolerance, 0.3 g of its mass, and each of the two solves has
  // an error of one tolerance. The probe goes 0.3 mm deep, so the contact is at most 2 √(2 · 10 · 0.3) =
  // 5 mm wide, and at most 4 × 4 nodes are affected.
  const Scene scene = sagging(3e-4);
  const double node_mass = scene.cloth.fabric.areal_density * 0.005 * 0.005;
  const double hidden = 16 * (3.0 + 2.0) * scene.solver.minimizer.tolerance * 9.81 * node_mass;
  Simulation awake(sagging(0.0)), sleeper(scene);
  run(awake, 1.0);
  run(sleeper, 1.0);
  ASSERT_EQ(sleeper.maxSpeed(), 0.0);
  const double top = particle(sleeper, 16, 16).z() + 0.01 + scene.cloth.fabric.thickness;
  double worst = 0.0;
  for (int step = 0; step <= 20000; ++step) {
    for (Simulation* simulation : {&awake, &sleeper}) {
      simulation->setDevice(Vec3(0.0, 0.0, top - 1.5e-8 * step), Vec3(0.0, 0.0, -1.5e-5));
      simulation->step();
    }
    worst = std::max(worst, (awake.probe().force - sleeper.probe().force).norm());
  }
  const double force = awake.probe().force.z();
  EXPECT_GT(force, 3.0 * hidden);
  record({"sleep", "worst error of a creeping probe's force [N]", "amrc", 0.0, worst, 0.0, force});
  EXPECT_LT(worst, tolerance(hidden));
}

/// Sheet that has come to rest, and to sleep where it may, on a box.
struct Lying {
  static constexpr double kFriction = 0.05;

  explicit Lying(double sleep_speed) : simulation(scene(sleep_speed)) { run(simulation, 0.3); }

  static Scene scene(double sleep_speed) {
    Scene scene = sheetScene(makeFabric({}), 17, 17, 0.08, 0.08);
    Obstacle box;
    box.size = Vec3(2.0, 2.0, 0.1);
    box.pose.position.z() = -0.05;
    box.friction = kFriction;
    scene.obstacles.push_back(box);
    scene.cloth.pose.position.z() = scene.cloth.fabric.thickness;
    scene.solver.sleep_speed = sleep_speed;
    return scene;
  }

  double acceleration() const { return kFriction * simulation.scene().gravity.norm(); }

  Simulation simulation;
};

TEST(Rest, ABeltCarriesClothThatSleeps) {
  // The friction, 0.05 g, is within the tolerance of a solve, 0.1 g: no residual tells of it.
  for (const double sleep_speed : {0.0, 3e-4}) {
    Lying lying(sleep_speed);
    Simulation& simulation = lying.simulation;
    const double h = simulation.scene().solver.time_step, speed = 0.06, time = 0.3, start = simulation.time(),
                 from = particle(simulation, 8, 8).x();
    ASSERT_EQ(simulation.maxSpeed(), 0.0);
    while (simulation.time() < start + time - 0.5 * h) {
      const double x = speed * (simulation.time() + h - start);
      simulation.moveObstacle(0, {Vec3(x, 0.0, -0.05), Quat::Identity()});
      simulation.step();
    }
    // Coulomb: it lags by v²/(2 μ g). The belt starts at its speed, and a step takes it there at once.
    const double way = speed * time - speed * speed / (2.0 * lying.acceleration());
    EXPECT_NEAR(particle(simulation, 8, 8).x() - from, way, tolerance(1.0) * speed * h) << sleep_speed;
  }
}

TEST(Rest, ATurntableCarriesCloth) {
  // The net force is 0 here, too.
  Lying lying(0.0);
  Simulation& simulation = lying.simulation;
  const double h = simulation.scene().solver.time_step, speed = 1.0, time = 0.4, start = simulation.time();
  const auto side = [&] { return Vec3(particle(simulation, 16, 8) - particle(simulation, 0, 8)); };
  while (simulation.time() < start + time - 0.5 * h) {
    const double angle = speed * (simulation.time() + h - start);
    simulation.moveObstacle(0, {Vec3(0.0, 0.0, -0.05), Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))});
    simulation.step();
  }
  // Friction turns a square of side a about its centre with μ g <r>/<r²>: <r> = 0.3826 a, <r²> = a²/6.
  const double a = 0.08, turns = lying.acceleration() * 0.3826 * 6.0 / a;
  const double lag = speed * speed / (2.0 * turns);
  // Nodes stand for areas of the size of a cell, a/16: <r> and <r²> to one in 16².  One step, as above.
  EXPECT_NEAR(std::atan2(side().y(), side().x()), speed * time - lag,
              tolerance(1.0) * (speed * h + 2.0 * lag / 256.0));
}

TEST(Rest, NewAdaptOptionsAreNotSleptThrough) {
  ClothWorld world(sagging(3e-4));
  for (int step = 0; step < 4000; ++step) world.step();
  ASSERT_LT(world.cloth().mesh().active(), 33 * 33);
  AdaptOptions options = world.scene().adapt;
  options.refine_above = 1e-6;
  options.coarsen_below = 1e-7;
  world.setAdaptOptions(options);
  int refined = 0;
  for (int step = 0; step < 10; ++step) refined += world.step().refined;
  EXPECT_GT(refined, 0);
}

TEST(Rest, ClothThatLosesItsSupportFallsAtAnyTolerance) {
  // The weight is below a tolerance of 1, but losing it must wake. From when the box is gone, the cloth is to
  // fall freely: g t²/2 = 0.11 m in 0.15 s; half of that is asked for.
  for (const double tolerance : {0.1, 1.0}) {
    Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"), 17,
                             17, 0.16, 0.16);
    scene.cloth.pose.position.z() = 0.0505;
    setStrategy(scene, Strategy::Finest, 0);
    Obstacle box;
    box.shape = Shape::Box;
    box.size = Vec3(0.2, 0.2, 0.1);
    box.friction = 0.0;
    scene.obstacles = {box};
    scene.air_damping = 0.0;
    scene.solver.minimizer.tolerance = tolerance;
    Simulation simulation(scene);
    run(simulation, 1.0);
    ASSERT_EQ(simulation.step().awake_particles, 0) << tolerance;
    const double rest = particle(simulation, 8, 8).z();
    for (int k = 1; k <= 20; ++k) {
      simulation.moveObstacle(0, {Vec3(0.0, 0.0, -0.05 * k), Quat::Identity()});
      simulation.step();
    }
    run(simulation, 0.15);
    EXPECT_LT(particle(simulation, 8, 8).z(), rest - 0.055) << tolerance;
  }
}

TEST(Rest, FreeFallNeverSleeps) {
  Scene scene = sagging(3e-4);
  scene.cloth.pins.clear();
  scene.air_damping = 0.0;
  Simulation simulation(scene);
  for (int step = 0; step < 100; ++step) simulation.step();
  const double h = scene.solver.time_step;
  EXPECT_NEAR(particle(simulation, 16, 16).z(), -9.81 * h * h * 100 * 101 / 2, tolerance(1e-9));
}

}  // namespace
}  // namespace haptic_cloth::rest_test
