/// Capsule probes, several probes, grasping, and moving obstacles.
/// Criteria: the closed solution of a strip pressed by a frictionless cylinder; Coulomb's law for a
/// pinch, a conveyor and carried cloth; weights.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"
#include "tools/run.h"

namespace haptic_cloth::fingers_test {
namespace {

constexpr double kGravity = 9.81;

/// Runs for `time` [s]; each device moves from its last position with its `velocity` [m/s].
void move(Simulation& simulation, std::vector<Vec3>& devices, const std::vector<Vec3>& velocities,
          double time, const Quat& orientation = Quat::Identity()) {
  const double h = simulation.scene().solver.time_step;
  for (double t = 0.5 * h; t < time; t += h) {
    for (std::size_t k = 0; k < devices.size(); ++k) {
      devices[k] += h * velocities[k];
      simulation.setDevice(static_cast<int>(k), {devices[k], velocities[k], orientation});
    }
    simulation.step();
  }
}

/// Force over E a of a weightless strip of half span a on a frictionless cylinder of radius r that
/// is pressed δ deep into its middle. The strip is straight from each support to a tangent: T = E
/// ε, F = 2 T sin θ.
double pressedStrip(double a, double r, double depth) {
  const double centre = r - depth;  // height of the axis above the supports
  const double theta = std::asin(r / std::hypot(a, centre)) - std::atan2(centre, a);
  const double straight = std::sqrt(a * a + centre * centre - r * r);
  const double strain = (straight + r * theta) / a - 1.0;
  return 2.0 * strain * std::sin(theta);
}

class PressedStrip : public testing::TestWithParam<Strategy> {};

TEST_P(PressedStrip, FeelsTheCapsuleAlongItsWholeSide) {
  using Strip = CapsuleOnStrip;
  constexpr double kRadius = Strip::kRadius, kThickness = Strip::kThickness;
  Simulation simulation(capsuleOnStrip(GetParam()));
  const Quat lying = lyingAlong(Vec3::UnitY());
  std::vector<Vec3> device{Vec3(0.0, 0.0, kRadius + 0.002)};
  move(simulation, device, {Vec3(0.0, 0.0, -0.1)}, 0.25, lying);
  move(simulation, device, {Vec3::Zero()}, 0.5, lying);
  const ProbeReport report = simulation.probe();
  // The cloth lies on the capsule, at most its thickness away.
  const double depth = kRadius - report.proxy.z();
  const double scale = Strip::kStiffness * Strip::kWidth;
  const double least = pressedStrip(Strip::kHalfSpan, kRadius, depth) * scale,
               most = pressedStrip(Strip::kHalfSpan, kRadius + kThickness, depth + kThickness) * scale;
  const double expected = 0.5 * (least + most);
  record(
      {"strip under a cylinder", "force [N]", name(GetParam()), depth, report.force.z(), expected, expected});
  EXPECT_NEAR(report.force.z(), expected, 0.5 * (most - least) + tolerance(0.01 * expected));
  EXPECT_NEAR(report.force.head<2>().norm(), 0.0, tolerance(0.005 * expected));
}

INSTANTIATE_TEST_SUITE_P(Strategies, PressedStrip, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

/// Slip of a stiff sheet that hangs upright between two probes pressing from both sides.
/// @param share its weight over the largest friction force, 2 μ N
/// @param times after the normal force is steady, increasing [s]
/// @return how far it has slipped by then, from a place that is the same for all [m]
std::vector<double> slipsOfPinched(double share, Strategy strategy, const std::vector<double>& times) {
  LinearFabric linear;
  linear.rigidity = 2e-3;  // keeps the sheet plane
  linear.areal_density = 0.5;
  Scene scene = sheetScene(makeFabric(linear), 17, 17, 0.08, 0.08);
  setStrategy(scene, strategy, 2);
  hangDown(scene);
  constexpr double kPress = 0.5, kStiffness = 1000.0, kRadius = 0.006;
  scene.probes.resize(2);
  scene.probes[0].name = "thumb";
  scene.probes[1].name = "index";
  const double weight = linear.areal_density * 0.08 * 0.08 * kGravity;
  for (ProbeOptions& probe : scene.probes) {
    probe.radius = kRadius;
    probe.coupling_stiffness = kStiffness;
    probe.friction = weight / (2.0 * kPress * share);
  }
  scene.solver.minimizer.tolerance = 0.01;
  scene.solver.minimizer.max_iterations = 2000;
  scene.solver.sleep_speed = 0.0;  // sleep would hold it, too
  Simulation simulation(scene);
  // Position and orientation of the sheet.
  const Vec3 middle = particle(simulation, 8, 8), along = (particle(simulation, 8, 16) - middle).normalized(),
             down = (particle(simulation, 16, 8) - middle).normalized(), out = along.cross(down);
  const double gap = 1e-4, apart = kRadius + linear.thickness + gap;  // a probe comes from outside
  std::vector<Vec3> device{middle + apart * out, middle - apart * out};
  // The probes press deeper by the stretch that gives the spring its force; the cloth yields by
  // less than its thickness.
  const double way = gap + kPress / kStiffness, close = 0.002;
  move(simulation, device, {Vec3::Zero(), Vec3::Zero()}, 0.001);
  move(simulation, device, {-(way / close) * out, (way / close) * out}, close);
  for (int k = 0; k < 10; ++k) {
    move(simulation, device, {Vec3::Zero(), Vec3::Zero()}, 0.01);
    // Keeps the normal force at N, as fingers do.
    for (const int p : {0, 1}) {
      const double press = std::abs(simulation.probe(p).force.dot(out));
      device[p] += (p == 0 ? -1.0 : 1.0) * (kPress - press) / kStiffness * out;
    }
  }
  std::vector<double> slips;
  double now = 0.0;
  for (const double time : times) {
    move(simulation, device, {Vec3::Zero(), Vec3::Zero()}, time - now);
    now = time;
    for (const int p : {0, 1}) {
      EXPECT_NEAR(std::abs(simulation.probe(p).force.dot(out)), kPress, tolerance(0.02 * kPress));
    }
    slips.push_back(particle(simulation, 8, 8).dot(down));
  }
  return slips;
}

class Pinch : public testing::TestWithParam<Strategy> {};

TEST_P(Pinch, HoldsUpToTwiceTheFriction) {
  // Held cloth hangs for ever: it must move by less than 1 µm/s.
  const std::vector<double> slips = slipsOfPinched(0.95, GetParam(), {0.4, 0.9});
  const double held = slips[1] - slips[0];
  record({"sheet pinched by two probes", "creep at 0.95 of 2 mu N [µm/s]", name(GetParam()), 0.95,
          1e6 * held / 0.5, 0.0, 1.0});
  EXPECT_LT(std::abs(held), tolerance(0.5 * 1e-6));
}

TEST_P(Pinch, SlipsBeyondTwiceTheFriction) {
  // The slip must be far from that of held cloth, ten times 0.15 mm. It soon leaves the probes.
  const std::vector<double> slips = slipsOfPinched(1.05, GetParam(), {0.0, 0.1});
  EXPECT_GT(slips[1] - slips[0], 10.0 * 0.5 * 3e-4);
}

INSTANTIATE_TEST_SUITE_P(Strategies, Pinch, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

/// Sheet on a floor.
Scene lying(Strategy strategy, double friction) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.1, 0.1);
  setStrategy(scene, strategy, 2);
  scene.cloth.pose.position.z() = 3e-4;
  Obstacle floor;
  floor.shape = Shape::Box;
  floor.name = "floor";
  floor.size = Vec3(0.5, 0.5, 0.1);
  floor.pose.position.z() = -0.05;
  floor.friction = friction;
  scene.obstacles.push_back(floor);
  return scene;
}

/// Shipped scene with its own paths. Only friction holds the lifted cloth: at most μ times the
/// normal force.
TEST(TwoFingers, TheShippedSceneLiftsTheClothByItsCorner) {
  Simulation simulation(loadScene(HAPTIC_CLOTH_SOURCE_DIR "/config/scenes/two_fingers.yaml"));
  const Scene& scene = simulation.scene();
  ASSERT_EQ(scene.probes.size(), 2u);
  const RunRecord record = runScene(simulation, Rows::None, nullptr);
  EXPECT_EQ(record.totals.failed_steps, 0);
  const Vec3 corner = particle(simulation, 32, 32);
  double lifted = 0.0;
  for (int k = 0; k < 2; ++k) {
    const ProbeOptions& probe = scene.probes[k];
    const Vec3 rise = probe.path.back().position - probe.path.front().position;
    lifted = std::max(lifted, rise.z());
    const ProbeReport report = simulation.probe(k);
    EXPECT_TRUE(report.contact) << probe.name;
    EXPECT_FALSE(report.grasps) << probe.name;
    // The pinched place lies between the fingers, about a radius from the corner.
    EXPECT_LT((corner - report.proxy).norm(), 3.0 * probe.radius) << probe.name;
  }
  EXPECT_GT(lifted, 0.05);
  EXPECT_GT(corner.z(), scene.cloth.pose.position.z() + 0.8 * lifted);
  const Vec3 held = simulation.probe(0).force + simulation.probe(1).force;
  const double weight = simulation.mass() * kGravity;
  EXPECT_LT(held.z(), -0.2 * weight) << "they carry some of the cloth";
  EXPECT_GE(held.z(), -1.2 * weight);
}

TEST(Grasp, LiftsTheClothAndFeelsItsWeight) {
  Scene scene = lying(Strategy::Amrc, 0.3);
  scene.air_damping = 5.0;
  Simulation simulation(scene);
  const Vec3 corner = particle(simulation, 2, 2);
  const double radius = scene.probes[0].radius;
  std::vector<Vec3> device{corner + Vec3(0.0, 0.0, radius + 0.002)};
  move(simulation, device, {Vec3(0.0, 0.0, -0.1)}, 0.025);
  ASSERT_TRUE(simulation.probe().contact);
  EXPECT_FALSE(simulation.probe().grasps);
  simulation.setGrasp(0, true);
  move(simulation, device, {Vec3(0.0, 0.0, 0.3)}, 0.7);
  move(simulation, device, {Vec3::Zero()}, 2.0);
  ASSERT_TRUE(simulation.probe().grasps);
  const double weight = simulation.mass() * kGravity;
  EXPECT_NEAR(simulation.supportForce().norm(), 0.0, tolerance(0.01 * weight)) << "off the floor";
  record(
      {"sheet lifted by a grasp", "force [N]", "amrc", 0.0, simulation.probe().force.z(), -weight, weight});
  EXPECT_NEAR(simulation.probe().force.z(), -weight, tolerance(0.02 * weight));
  EXPECT_LT((particle(simulation, 2, 2) - simulation.probe().proxy).norm(), radius + 0.01);

  simulation.setGrasp(0, false);
  move(simulation, device, {Vec3(0.0, 0.0, 1.0)}, 0.05);
  EXPECT_FALSE(simulation.probe().grasps);
  move(simulation, device, {Vec3::Zero()}, 0.1);
  EXPECT_FALSE(simulation.probe().contact) << "let go";
  simulation.setGrasp(0, true);
  move(simulation, device, {Vec3::Zero()}, 0.01);
  EXPECT_FALSE(simulation.probe().grasps) << "what it held before is far away";
}

TEST(Grasp, ClosedInTheAirItTakesWhatItMeets) {
  Scene scene = lying(Strategy::Finest, 0.3);
  Simulation simulation(scene);
  std::vector<Vec3> device{Vec3(0.0, 0.0, scene.probes[0].radius + 0.005)};
  move(simulation, device, {Vec3::Zero()}, 0.002);
  simulation.setGrasp(0, true);
  move(simulation, device, {Vec3::Zero()}, 0.01);
  EXPECT_FALSE(simulation.probe().grasps);
  move(simulation, device, {Vec3(0.0, 0.0, -0.2)}, 0.03);
  EXPECT_TRUE(simulation.probe().grasps);
}

class Conveyor : public testing::TestWithParam<Strategy> {};

TEST_P(Conveyor, CarriesTheSheetAtTheRateOfItsFriction) {
  constexpr double kFriction = 0.2, kSpeed = 0.4, kRest = 0.1, kTime = 0.1;
  Scene scene = lying(GetParam(), kFriction);
  scene.air_damping = 0.0;
  scene.solver.minimizer.tolerance = 0.01;
  scene.solver.minimizer.max_iterations = 1000;
  Simulation simulation(scene);
  std::vector<Vec3> none;
  move(simulation, none, {}, kRest);
  const double h = scene.solver.time_step, before = particle(simulation, 16, 16).x();
  Pose floor = simulation.obstaclePose(0);
  const auto run = [&](double time) {
    for (double t = 0.5 * h; t < time; t += h) {
      floor.position.x() += h * kSpeed;
      simulation.moveObstacle(0, floor);
      simulation.step();
    }
    return particle(simulation, 16, 16).x() - before;
  };
  // v = μ g t up to the speed of the floor at 0.204 s, then constant.
  const double way = run(kTime), free = 0.5 * kFriction * kGravity * kTime * kTime;
  record({"sheet on a moving floor", "way after 0.1 s [mm]", name(GetParam()), kTime, 1e3 * way, 1e3 * free,
          1e3 * free});
  EXPECT_NEAR(way, free, tolerance(0.05 * free));
  run(0.2);
  const double from = particle(simulation, 16, 16).x();
  run(0.1);
  EXPECT_NEAR((particle(simulation, 16, 16).x() - from) / 0.1, kSpeed, tolerance(0.01 * kSpeed));
  EXPECT_GT(simulation.energy().dissipated, 0.0) << "it slid";
}

INSTANTIATE_TEST_SUITE_P(Strategies, Conveyor, testing::Values(Strategy::Finest, Strategy::Coarsest),
                         [](const auto& info) { return name(info.param); });

TEST(MovingObstacle, LiftsTheClothAndPaysForIt) {
  Scene scene = lying(Strategy::Amrc, 0.3);
  scene.air_damping = 0.0;
  Simulation simulation(scene);
  std::vector<Vec3> none;
  move(simulation, none, {}, 0.3);
  const EnergyReport before = simulation.energy();
  const double h = scene.solver.time_step, speed = 0.1, time = 0.5;
  Pose floor = simulation.obstaclePose(0);
  double deepest = 0.0;
  for (double t = 0.5 * h; t < time; t += h) {
    floor.position.z() += h * speed;
    simulation.moveObstacle(0, floor);
    deepest = std::max(deepest, simulation.step().max_penetration);
  }
  move(simulation, none, {}, 0.2);
  const EnergyReport after = simulation.energy();
  const double lifted = simulation.mass() * kGravity * speed * time;
  EXPECT_NEAR(after.gravity - before.gravity, lifted, tolerance(0.01 * lifted));
  // The work of the floor equals the energy gained by the cloth plus losses; starting and stopping
  // cost about m v².
  const double lost = after.dissipated - before.dissipated, start = simulation.mass() * speed * speed;
  EXPECT_GE(lost, -tolerance(0.01 * lifted));
  EXPECT_LE(lost, 2.0 * start + tolerance(0.05 * lifted));
  EXPECT_EQ(deepest, 0.0);
}

TEST(MovingObstacle, SentTooFarItLagsAndNothingPassesThrough) {
  Scene scene = lying(Strategy::Finest, 0.3);
  Simulation simulation(scene);
  Pose floor = simulation.obstaclePose(0);
  floor.position.z() += 0.1;  // in one jump
  simulation.moveObstacle(0, floor);
  simulation.step();
  EXPECT_NEAR(simulation.obstaclePose(0).position.z(), -0.05 + 0.25 * 0.05, 1e-12);
  for (int k = 0; k < 400; ++k) simulation.step();
  EXPECT_EQ(simulation.obstaclePose(0).position.z(), floor.position.z());
  for (const int i : {0, 8, 16, 32}) EXPECT_GT(particle(simulation, i, 16).z(), 0.1);
}

}  // namespace
}  // namespace haptic_cloth::fingers_test
