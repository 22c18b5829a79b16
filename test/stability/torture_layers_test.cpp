/// Cloth that meets itself in hard cases: tumbled, wrung, piled up, pushed through itself, hammered while
/// folded, cut short, much too thick, soft, rough or slippery.
/// Criteria: those of every case (test/support/torture.h), of which no crossing is what matters here. Each
/// case must press layers on each other, else it would say nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/tolerance.h"
#include "support/torture.h"

namespace haptic_cloth::torture_layers_test {
namespace {

/// Length of a case that can go on for any time [s]. @param short_form what suits every build [s]
double lengthOf(double short_form) { return short_form * tortureLength("HAPTIC_CLOTH_TORTURE_LAYERS", 1.0); }

void tortureLayers(const Torture& wanted) {
  EXPECT_GT(torture(wanted).pairs, 0) << wanted.name << ": no layers met";
}

Obstacle floorAt(double height) {
  Obstacle floor;
  floor.pose.position.z() = height;
  return floor;
}

// Share of the turnover that normals may create by turning where a floor or walls push folds along. A floor
// that moves by most of a cell in a step: twice the worst of 160 runs that began 1 μm higher each. Walls that
// turn for 3 s reach a quarter of it.
constexpr double kPushedFolds = 0.05;

/// Strip of 12 x 2 cm that stands on its end, leans a little and falls onto itself on a floor.
Torture pile(const std::string& name, const std::string& fabric) {
  Torture strip = tortureSheet(name, fabric, 25, 5, 0.12, 0.02);
  setStrategy(strip.scene, Strategy::Amrc, 2);
  const double lean = 0.02;
  strip.scene.cloth.pose.orientation = Quat(Eigen::AngleAxisd(-0.5 * EIGEN_PI - lean, Vec3::UnitY()));
  strip.scene.obstacles = {floorAt(-0.06 - 3.0 * strip.scene.cloth.fabric.thickness)};
  strip.scene.stop.time = 0.25;
  // A split halves the arms on which sharp folds turn, so it doubles their energy until the step is solved.
  // All folds of a pile may split at once; in 360 runs that began 1 μm higher each they held up to 0.16.
  strip.limits.created = 0.2;
  return strip;
}

std::string fabricOf(double thickness, double stiffness, double rigidity) {
  LinearFabric linear;
  linear.thickness = thickness;
  linear.stiffness = stiffness;
  linear.rigidity = rigidity;
  linear.compression = 0.1;
  return writeFabric(linear);
}

TEST(Torture, FoldsOnAFloorThatRises) {
  // The floor rises by up to ten thicknesses in a step, below a pile that has just begun to fold. Cloth must
  // not end inside it: what holds the floor back there is the weight of the pile, not the layers above.
  for (const auto& [speed, time_step] : {std::pair(1.5, 2e-3), {2.0, 2e-3}}) {
    for (const char* fabric : {"wool_tropical", "winter_suiting"}) {
      const std::string name = std::string("rising_floor_") + fabric + "_" +
                               std::to_string(std::lround(1e6 * speed * time_step)) + "um";
      Torture strip = pile(name, shippedFabric(fabric));
      strip.scene.solver.time_step = time_step;
      strip.limits.turned = kPushedFolds;
      const Pose start = strip.scene.obstacles[0].pose;
      strip.before = [start, speed = speed](ClothWorld& world, long step) {
        const double end = static_cast<double>(step + 1) * world.scene().solver.time_step;
        world.moveObstacle(0, {start.position + Vec3(0.0, 0.0, speed * end), start.orientation});
      };
      const TortureResult result = torture(strip);
      EXPECT_GT(result.pairs, 0) << name << ": no layers met";
      EXPECT_LE(result.penetration, tolerance(strip.scene.cloth.fabric.thickness)) << name;
    }
  }
}

TEST(Torture, TumbledInADrum) {
  // Four planes close around the cloth and turn about it, once in 0.4 s. So gravity flips on folds.
  Torture sheet = tortureSheet("drum", fabricOf(5e-4, 500.0, 4e-6), 17, 17, 0.08, 0.08);
  setStrategy(sheet.scene, Strategy::Amrc, 2);
  sheet.scene.obstacles.resize(4);
  const auto wall = [](int k, double time) {
    const double radius = std::max(0.008, 0.045 - 0.2 * time), turned = 2.0 * EIGEN_PI / 0.4 * time;
    const Quat turn(Eigen::AngleAxisd(turned + 0.5 * EIGEN_PI * k, Vec3::UnitY()));
    return Pose{turn * Vec3(0.0, 0.0, -radius), turn};
  };
  for (int k = 0; k < 4; ++k) sheet.scene.obstacles[k].pose = wall(k, 0.0);
  sheet.before = [wall](ClothWorld& world, long step) {
    const double end = static_cast<double>(step + 1) * world.scene().solver.time_step;
    for (int k = 0; k < 4; ++k) world.moveObstacle(k, wall(k, end));
  };
  sheet.scene.stop.time = lengthOf(0.3);
  sheet.limits.turned = kPushedFolds;
  tortureLayers(sheet);
}

TEST(Torture, CrumpledByGripsAtRandom) {
  // Four grips take a sheet near its corners and pull each of them to another place every 0.05 s.
  Torture sheet = tortureSheet("crumpled", fabricOf(5e-4, 500.0, 4e-6), 13, 13, 0.09, 0.09);
  setStrategy(sheet.scene, Strategy::Amrc, 2);
  const double time = lengthOf(0.12);
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> place(-0.03, 0.03);
  sheet.scene.probes.assign(4, gripper(0.01, 200.0));
  for (int k = 0; k < 4; ++k) {
    ProbeOptions& grip = sheet.scene.probes[k];
    grip.name = "grip" + std::to_string(k);
    const Vec3 corner(k % 2 == 0 ? -0.035 : 0.035, k / 2 == 0 ? -0.035 : 0.035, 0.0);
    grip.path = {{0.0, corner + Vec3(0.0, 0.0, 0.0055)}, {0.01, corner + Vec3(0.0, 0.0, 0.003)}};
    for (double t = 0.06; t < time + 0.05; t += 0.05)
      grip.path.push_back({t, Vec3(place(generator), place(generator), place(generator))});
    grip.grasp = {{0.0, 2.0 * time}};
  }
  sheet.scene.solver.minimizer.max_iterations = 50;
  sheet.scene.stop.time = time;
  sheet.limits.pushed = true;
  tortureLayers(sheet);
}

/// Sheet whose opposite sides are turned against each other, once in 0.2 s.
Torture wrungSheet(const std::string& name) {
  Torture sheet = tortureSheet(name, fabricOf(5e-4, 500.0, 4e-6), 17, 17, 0.1, 0.1);
  setStrategy(sheet.scene, Strategy::Amrc, 2);
  sheet.scene.gravity.setZero();
  pin(sheet.scene, 0, 0, 0, 16);
  pin(sheet.scene, 16, 16, 0, 16);
  for (const int k : {0, 1}) {
    const double side = k == 0 ? 1.0 : -1.0;
    sheet.scene.cloth.pins[k].turn = Vec3(side * 2.0 * EIGEN_PI / 0.4, 0.0, 0.0);
    sheet.scene.cloth.pins[k].velocity = Vec3(side * 0.08, 0.0, 0.0);
  }
  sheet.scene.stop.time = 0.2;
  // One iteration leaves nearly all of a pin's way to the cells beside it: at most the distance that two
  // places of a pin can have, over the width of a cell.
  sheet.limits.strain = (0.1 + 0.08 * sheet.scene.stop.time) / (0.1 / 16.0);
  return sheet;
}

class TortureWrung : public testing::TestWithParam<int> {};

TEST_P(TortureWrung, WithFewIterations) {
  // 0 means no time, as in TortureBudget.
  const int iterations = GetParam();
  Torture sheet = wrungSheet("wrung_" + std::to_string(iterations));
  sheet.scene.solver.minimizer.max_iterations = std::max(1, iterations);
  if (iterations == 0) sheet.scene.solver.minimizer.time_budget = 1e-12;
  tortureLayers(sheet);
}

INSTANTIATE_TEST_SUITE_P(Iterations, TortureWrung, testing::Values(0, 3));

class TortureTurned : public testing::TestWithParam<int> {};

TEST_P(TortureTurned, ByAHandThatHolds) {
  // A grip takes the middle of a sheet that is held at its corners, and turns about the normal there, three
  // times in 0.4 s and faster than a hand: the sheet winds up in folds.
  constexpr double kRate = 47.0, kArm = 0.009;  // [rad/s], half the length of what the grip holds [m]
  const int iterations = GetParam();
  Torture sheet = tortureSheet("turned_grasp_" + std::to_string(iterations), fabricOf(5e-4, 500.0, 4e-6), 17,
                               17, 0.1, 0.1);
  setStrategy(sheet.scene, Strategy::Amrc, 2);
  sheet.scene.cloth.pins = {{0, 0, 0, 0}, {16, 16, 0, 0}, {0, 0, 16, 16}, {16, 16, 16, 16}};
  const ProbeOptions grip = gripper(0.01, 400.0);
  sheet.scene.probes = {grip};
  sheet.before = [grip](ClothWorld& world, long step) {
    const double end = static_cast<double>(step + 1) * world.scene().solver.time_step;
    const double height = 0.0055 - 0.25 * std::min(end, 0.01), turned = kRate * std::max(0.0, end - 0.02);
    world.setGrasp(0, true);
    world.setDevice(0, {Vec3(0.0, 0.0, height), Vec3::Zero(),
                        Quat(Eigen::AngleAxisd(turned, Vec3::UnitZ())) * grip.orientation});
  };
  if (iterations > 0) sheet.scene.solver.minimizer.max_iterations = iterations;
  sheet.scene.stop.time = lengthOf(0.4);
  sheet.limits.thrown = 2.0 * kRate * kArm;
  // A thread from a corner to the grip is wound up at most so far, over its length.
  const double wound = kArm * kRate * (sheet.scene.stop.time - 0.02);
  sheet.limits.strain = wound / (std::hypot(0.05, 0.05) - kArm);
  tortureLayers(sheet);
}

INSTANTIATE_TEST_SUITE_P(Iterations, TortureTurned, testing::Values(0, 3));

class TorturePile : public testing::TestWithParam<int> {};

TEST_P(TorturePile, WithFewIterations) {
  const int iterations = GetParam();
  Torture strip = pile("pile_budget_" + std::to_string(iterations), fabricOf(5e-4, 500.0, 1e-6));
  strip.scene.solver.minimizer.max_iterations = std::max(1, iterations);
  if (iterations == 0) strip.scene.solver.minimizer.time_budget = 1e-12;
  strip.scene.stop.time = 0.6;
  tortureLayers(strip);
}

INSTANTIATE_TEST_SUITE_P(Iterations, TorturePile, testing::Values(0, 3));

class TortureLoops : public testing::TestWithParam<int> {};

TEST_P(TortureLoops, ThatTouch) {
  // The ends of a strip are pushed past each other, so that it hangs in a loop whose sides touch, and
  // the pins stop each other. Then the same in long steps of one iteration.
  const int length = GetParam();
  Torture strip =
      tortureSheet("loops_" + std::to_string(length) + "ms", fabricOf(5e-4, 500.0, 4e-6), 33, 9, 0.16, 0.04);
  setStrategy(strip.scene, Strategy::Amrc, 2);
  pin(strip.scene, 0, 0, 0, 8);
  pin(strip.scene, 32, 32, 0, 8);
  const double speed = length > 1 ? 1.4 : 0.4, step = 1e-3 * length;
  strip.scene.cloth.pins[0].velocity = Vec3(speed, 0.0, 0.0);
  strip.scene.cloth.pins[1].velocity = Vec3(-speed, 0.0, 0.0);
  strip.scene.solver.time_step = step;
  strip.scene.stop.time = length > 1 ? 0.8 : 0.3;
  if (length > 1) {
    strip.scene.solver.minimizer.time_budget = 1e-12;
    // A pin that catches up makes twice its way in a step, and an iteration may leave all of it to one cell.
    // That cell may be twice as long as at rest before: steps without such a jump reach strains of 1.1
    // to 1.7.
    strip.limits.strain = 1.0 + 2.0 * speed * step / 0.005;
  }
  tortureLayers(strip);
}

INSTANTIATE_TEST_SUITE_P(Steps, TortureLoops, testing::Values(1, 8));

TEST(Torture, ProbeHammersAFold) {
  // A probe beats a pile of folds 20 times a second, with 1 m/s.
  Torture strip = pile("hammer", fabricOf(5e-4, 500.0, 4e-6));
  const double time = lengthOf(0.4);
  std::vector<PathPoint>& path = strip.scene.probes[0].path;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(-0.01, 0.01);
  path = {{0.0, Vec3(0.0, 0.0, 0.1)}, {0.2, Vec3(0.0, 0.0, -0.03)}};
  for (double t = 0.225; t < time + 0.05; t += 0.05) {
    path.push_back({t, Vec3(place(generator), place(generator), -0.055)});
    path.push_back({t + 0.025, Vec3(place(generator), place(generator), -0.03)});
  }
  strip.scene.stop.time = time;
  strip.limits.pushed = true;
  tortureLayers(strip);
}

/// The steepest law of compression that a fabric file may hold. Where folds lie across each other, nodes of a
/// split may begin deep in it: in 60 runs that began 1 μm higher each they held up to 31 times the turnover.
/// The same step must let go of all that; in these runs it left 0.04 %.
TEST(Torture, PileOfAFabricThatHardlyYields) {
  LinearFabric linear;
  linear.thickness = 1e-3;
  linear.rigidity = 4e-6;
  linear.compression = 0.1;
  linear.measured = Compression{1e-3, 0.99e-3, 0.05};
  Torture strip = pile("pile_hard", writeFabric(linear));
  strip.scene.stop.time = 0.5;
  strip.limits.created = 60.0;
  const TortureResult result = torture(strip);
  EXPECT_GT(result.pairs, 0);
  EXPECT_LT(result.gain, tolerance(1e-3 * result.energy));
}

struct Extreme {
  const char* name;
  double thickness, stiffness, rigidity;  ///< [m], [N/m], [N m]
  double friction;                        ///< between layers
};

void PrintTo(const Extreme& value, std::ostream* out) { *out << value.name; }

class TortureExtreme : public testing::TestWithParam<Extreme> {};

TEST_P(TortureExtreme, FallsInFolds) {
  const Extreme& extreme = GetParam();
  Torture strip = pile(std::string("pile_") + extreme.name,
                       fabricOf(extreme.thickness, extreme.stiffness, extreme.rigidity));
  strip.scene.cloth.self_friction = extreme.friction;
  tortureLayers(strip);
}

// Cells are 5 mm wide.
INSTANTIATE_TEST_SUITE_P(
    Fabrics, TortureExtreme,
    testing::Values(Extreme{"thin", 2e-5, 500.0, 4e-6, 0.3}, Extreme{"thick", 8e-3, 500.0, 4e-6, 0.3},
                    Extreme{"soft", 5e-4, 50.0, 1e-6, 0.3}, Extreme{"stiff", 5e-4, 2e4, 4e-6, 0.3},
                    Extreme{"slippery", 5e-4, 500.0, 4e-6, 0.0}, Extreme{"rough", 5e-4, 500.0, 4e-6, 2.0}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace haptic_cloth::torture_layers_test
