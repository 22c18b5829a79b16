/// Cloth that meets itself.
/// Criterion: after no step does an edge of the surface cut a triangle of it; the check is exact and
/// has no tolerance (contact/crossings.h). Without self-contact each scene crosses itself, so each
/// can fail.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <random>

#include "support/scenes.h"

namespace haptic_cloth::self_crossing_test {
namespace {

/// A scene and what happens in it before each step.
struct Meeting {
  Scene scene;
  double time;  ///< length of the run [s]
  std::function<void(Simulation&)> before_step = followAll;

  static void followAll(Simulation& simulation) { followPaths(simulation); }
};

Scene shipped(const std::string& name, const std::vector<std::string>& overrides) {
  Scene scene = loadScene(HAPTIC_CLOTH_SOURCE_DIR "/bench/scenes/" + name + ".yaml", overrides);
  scene.solver.threads = 1;
  return scene;
}

Fabric lightFabric() {
  LinearFabric linear;
  linear.stiffness = 500.0;
  linear.rigidity = 4e-6;
  linear.compression = 0.1;
  return makeFabric(linear);
}

/// Adaptive sheet in the air.
Scene lightSheet(int columns, int rows, double length, double width) {
  Scene scene = sheetScene(lightFabric(), columns, rows, length, width);
  scene.air_damping = 0.5;
  setStrategy(scene, Strategy::Amrc, 2);
  return scene;
}

Obstacle floorAt(double height) {
  Obstacle floor;
  floor.pose.position.z() = height;
  floor.friction = 0.4;
  return floor;
}

Obstacle box(const Vec3& size, const std::vector<PathPoint>& path) {
  Obstacle box;
  box.shape = Shape::Box;
  box.size = size;
  box.path = path;
  box.pose.position = path.front().position;
  return box;
}

Meeting ribbon() { return {shipped("ribbon", {"cloth.particles=[49, 9]"}), 0.3}; }

Meeting finestRibbon() {
  return {shipped("ribbon", {"cloth.particles=[49, 9]", "adapt.strategy=finest"}), 0.3};
}

Meeting ribbonOfFewIterations() {
  return {shipped("ribbon", {"cloth.particles=[49, 9]", "solver.max_iterations=3"}), 0.3};
}

Meeting ribbonOfSecondOrder() {
  return {shipped("ribbon", {"cloth.particles=[49, 9]", "solver.integrator=bdf2"}), 0.3};
}

/// Ten times as fast as the benchmark.
Meeting twist() {
  Scene scene = shipped("twist", {"cloth.particles=[25, 25]"});
  for (Pin& pin : scene.cloth.pins) {
    pin.turn *= 10.0;
    pin.velocity *= 10.0;
  }
  return {scene, 0.2};
}

Meeting fold() { return {shipped("fold", {"cloth.particles=[25, 25]"}), 1.0}; }

/// A strip on a floor whose end a probe carries to its other end, and then the fold the same way.
Meeting foldedTwice() {
  Scene scene = lightSheet(41, 9, 0.2, 0.04);
  scene.cloth.pose.position.z() = 5e-4;
  scene.obstacles = {floorAt(0.0)};
  ProbeOptions& probe = scene.probes[0];
  probe.radius = 0.004;
  probe.length = 0.03;
  probe.orientation = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitX()));  // across the strip
  const auto at = [](double time, double x, double z) { return PathPoint{time, Vec3(x, 0.0, z)}; };
  probe.path = {at(0.0, 0.098, 0.010),  at(0.05, 0.098, 0.0038), at(0.20, 0.02, 0.06),
                at(0.35, -0.09, 0.006), at(0.40, -0.09, 0.03),   at(0.50, 0.0, 0.03),
                at(0.55, 0.0, 0.0045),  at(0.65, -0.04, 0.04),   at(0.80, -0.09, 0.007),
                at(0.85, -0.09, 0.03)};
  probe.grasp = {{0.05, 0.37}, {0.55, 0.82}};
  return {scene, 0.85};
}

/// Four boxes close around a sheet that lies on a floor.
Meeting closingBoxes() {
  Scene scene = lightSheet(25, 25, 0.1, 0.1);
  scene.cloth.pose.position.z() = 5e-4;
  scene.obstacles = {floorAt(0.0)};
  for (const double side : {-1.0, 1.0}) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
      const Vec3 height(0.0, 0.0, 0.05);
      scene.obstacles.push_back(
          box(Vec3(0.04, 0.04, 0.1) + 0.26 * Vec3(1, 1, 0) - 0.26 * axis,
              {{0.0, height + 0.071 * side * axis}, {0.4, height + 0.04 * side * axis}}));
    }
  }
  return {scene, 0.4};
}

/// A hanging strip is wound up by its first three columns, which turn about the second.
Meeting rolling() {
  Scene scene = lightSheet(33, 9, 0.12, 0.03);
  hangDown(scene);
  pin(scene, 0, 2, 0, 8);
  scene.cloth.pins[0].turn = Vec3(0.0, 25.0, 0.0);
  scene.cloth.pins[0].centre = Vec3(0.0, 0.0, 0.06 - 0.12 / 32.0);
  return {scene, 0.5};
}

/// The ends of a strip come together, so that it hangs as a loop; a probe pushes one side of the loop
/// through the other.
Meeting pushedFold() {
  Scene scene = lightSheet(33, 9, 0.16, 0.04);
  scene.air_damping = 4.0;
  pin(scene, 0, 0, 0, 8);
  pin(scene, 32, 32, 0, 8);
  scene.cloth.pins[0].velocity = Vec3(0.14, 0.0, 0.0);
  scene.cloth.pins[1].velocity = Vec3(-0.14, 0.0, 0.0);
  scene.probes[0].path = {
      {0.0, Vec3(0.10, 0.0, -0.03)}, {0.35, Vec3(0.06, 0.0, -0.03)}, {0.5, Vec3(-0.07, 0.0, -0.03)}};
  return {scene, 0.5};
}

/// Two fingers push a fold of a sheet on a floor together and pinch it.
Meeting pinching() {
  Scene scene = lightSheet(33, 17, 0.12, 0.06);
  scene.cloth.pose.position.z() = 5e-4;
  scene.obstacles = {floorAt(0.0)};
  scene.obstacles[0].friction = 0.1;
  scene.probes.resize(2);
  scene.probes[1].name = "other";
  for (const int k : {0, 1}) {
    ProbeOptions& probe = scene.probes[k];
    const double side = k == 0 ? -1.0 : 1.0;
    probe.radius = 0.006;
    probe.friction = 1.5;
    probe.path = {{0.0, Vec3(0.02 * side, 0.0, 0.012)},
                  {0.05, Vec3(0.02 * side, 0.0, 0.0045)},
                  {0.35, Vec3(0.0055 * side, 0.0, 0.0045)},
                  {0.40, Vec3(0.0050 * side, 0.0, 0.0050)}};
  }
  return {scene, 0.4};
}

/// A wrung sheet whose mesh is refined and coarsened by turns, in every step.
Meeting changingMesh() {
  Meeting meeting = twist();
  meeting.scene.adapt.interval = 1;
  meeting.scene.adapt.minimum_age = 0;
  meeting.before_step = [](Simulation& simulation) {
    AdaptOptions adapt = simulation.scene().adapt;
    const bool fine = std::lround(simulation.time() / simulation.scene().solver.time_step) % 2 == 0;
    adapt.refine_above = fine ? 0.02 : 2.0;
    adapt.coarsen_below = fine ? 0.01 : 1.5;
    adapt.refine_above_strain = fine ? 1e-4 : 0.1;
    adapt.coarsen_below_strain = fine ? 5e-5 : 0.05;
    simulation.setOptions(simulation.scene().solver, adapt, simulation.scene().air_damping);
  };
  return meeting;
}

/// A sheet falls, turned at random, into the corner between three planes.
Meeting intoACorner(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> number;
  Scene scene = lightSheet(25, 25, 0.12, 0.12);
  scene.cloth.pose.orientation =
      Quat(number(random), number(random), number(random), number(random)).normalized();
  scene.cloth.pose.position = Vec3(0.0, 0.0, 0.09);
  for (const int k : {0, 1, 2}) {
    const double angle = 2.0 * EIGEN_PI * k / 3.0;
    Obstacle plane;
    plane.friction = 0.3;
    plane.pose.position.z() = -0.06;
    plane.pose.orientation = lyingAlong(Vec3(std::cos(angle), std::sin(angle), 0.7).normalized());
    scene.obstacles.push_back(plane);
  }
  return {scene, 0.35};
}

struct Case {
  const char* name;
  std::function<Meeting()> meeting;
};

void PrintTo(const Case& value, std::ostream* out) { *out << value.name; }

/// Steps the scene. @return largest number of pairs after a step
int mostCrossings(const Meeting& meeting) {
  Simulation simulation(meeting.scene);
  Crossings first;
  double from = 0.0;
  int most = 0, failed = 0;
  while (simulation.time() < meeting.time - 1e-9) {
    meeting.before_step(simulation);
    failed += simulation.step().failed ? 1 : 0;
    const Crossings now = simulation.crossings();
    if (most == 0 && now.pairs > 0) {
      first = now;
      from = simulation.time();
    }
    most = std::max(most, now.pairs);
  }
  EXPECT_EQ(failed, 0);
  if (most > 0) {
    std::cout << "  crosses from " << from << " s on, first in cells (" << first.cell[0] << ", "
              << first.cell[1] << ") and (" << first.other[0] << ", " << first.other[1] << ") at "
              << first.position.transpose() << " m; at most " << most << " pairs\n";
  }
  return most;
}

class SelfCrossing : public testing::TestWithParam<Case> {};

TEST_P(SelfCrossing, IsMissedWhereItIsOff) {
  Meeting meeting = GetParam().meeting();
  meeting.scene.cloth.self_contact = false;
  EXPECT_GT(mostCrossings(meeting), 0);
}

TEST_P(SelfCrossing, LetsNothingCross) {
  Meeting meeting = GetParam().meeting();
  meeting.scene.cloth.self_contact = true;
  EXPECT_EQ(mostCrossings(meeting), 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SelfCrossing,
                         testing::Values(Case{"ribbon", ribbon}, Case{"finest_ribbon", finestRibbon},
                                         Case{"ribbon_of_few_iterations", ribbonOfFewIterations},
                                         Case{"ribbon_of_second_order", ribbonOfSecondOrder},
                                         Case{"changing_mesh", changingMesh}, Case{"twist", twist},
                                         Case{"fold", fold}, Case{"folded_twice", foldedTwice},
                                         Case{"closing_boxes", closingBoxes}, Case{"rolling", rolling},
                                         Case{"pushed_fold", pushedFold}, Case{"pinching", pinching},
                                         Case{"corner_4", [] { return intoACorner(4); }},
                                         Case{"corner_2", [] { return intoACorner(2); }},
                                         Case{"corner_3", [] { return intoACorner(3); }}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace haptic_cloth::self_crossing_test
