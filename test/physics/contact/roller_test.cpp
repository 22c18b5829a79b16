/// A roller that turns below a taut strip.
/// Criterion: it drags the strip by Coulomb's friction, T₁ = T₂ exp(μ α) with the angle α of the wrap
/// (Euler and Eytelwein), to 2 % of μ, of which the cells leave 0.8 %, however far it turns in a step. The
/// tensions are those of the linear law at the stretch of the free spans, and α is the angle between them.
/// The dissipated energy is the work of friction, T₁ − T₂ times the way of the roller's surface, to 2 %.
///
/// Without friction a roller that turns about its own axis does no work, whichever way the cloth slides: 5 %
/// of what the sliding strip dissipates are left for the difference between its expected and its real motion
/// in a step, which is of second order (2.5 % at 100 rad/s).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "support/scenes.h"

namespace haptic_cloth::roller_test {
namespace {

constexpr double kLength = 0.2, kWidth = 0.02;  // of the strip [m]
constexpr double kStiffness = 1000.0;           // [N/m]
constexpr int kColumns = 129, kRows = 5, kSpan = 16;
constexpr double kLift = 0.05;  // of the roller [m]

struct Roller {
  double friction, radius, length, turn, time_step;  ///< [-], [m], [m], [rad in a step], [s]
};

/// Weightless strip along x, held at both ends; the roller lies along y below its middle.
Scene stripOver(const Roller& roller) {
  LinearFabric linear;
  linear.stiffness = kStiffness;
  Scene scene = sheetScene(makeFabric(linear), kColumns, kRows, kLength, kWidth);
  scene.gravity.setZero();
  scene.air_damping = 2.0;
  scene.cloth.self_contact = false;
  pin(scene, 0, 0, 0, kRows - 1);
  pin(scene, kColumns - 1, kColumns - 1, 0, kRows - 1);
  Obstacle obstacle;
  obstacle.shape = Shape::Cylinder;
  obstacle.radius = roller.radius;
  obstacle.length = roller.length;
  obstacle.friction = roller.friction;
  obstacle.pose.orientation = lyingAlong(Vec3::UnitY());
  obstacle.pose.position = Vec3(0.0, 0.0, -roller.radius - 1e-3);
  scene.obstacles.push_back(obstacle);
  scene.solver.time_step = roller.time_step;
  scene.solver.minimizer.tolerance = 0.02;
  return scene;
}

/// Free span of the strip at one of its ends.
struct Span {
  Vec3 along = Vec3::Zero();  ///< of its middle line, towards +x [m]
  double strain = 0.0;        ///< mean of it [-]

  Span(const std::vector<Vec3>& positions, int first) {
    const auto at = [&](int i, int j) { return positions[j * kColumns + i]; };
    along = at(first + kSpan, kRows / 2) - at(first, kRows / 2);
    for (int j = 0; j < kRows; ++j) {
      const double share = (j == 0 || j == kRows - 1 ? 0.5 : 1.0) / (kRows - 1);
      for (int i = first; i < first + kSpan; ++i)
        strain += share * ((at(i + 1, j) - at(i, j)).norm() / (kLength / (kColumns - 1)) - 1.0) / kSpan;
    }
  }
};

class RollerTest : public testing::TestWithParam<Roller> {};

TEST_P(RollerTest, DragsByCoulombsFriction) {
  const Roller roller = GetParam();
  Simulation simulation(stripOver(roller));
  const Pose start = simulation.obstaclePose(0);
  double turned = 0.0, dissipated = 0.0, way = 0.0;
  for (double time = roller.time_step; time < 1.2; time += roller.time_step) {
    if (time > 0.4) turned += roller.turn;
    const Vec3 lifted(0.0, 0.0, std::min(time / 0.3, 1.0) * kLift);
    const Quat turn(Eigen::AngleAxisd(turned, Vec3::UnitY()));
    simulation.moveObstacle(0, {start.position + lifted, turn * start.orientation});
    simulation.step();
    if (time < 1.0) {
      dissipated = simulation.energy().dissipated;
    } else {
      way += roller.turn * roller.radius;
    }
  }
  std::vector<Vec3> positions;
  simulation.positions(positions);
  const Span left(positions, 0), right(positions, kColumns - 1 - kSpan);
  const double wrap =
      std::atan2(left.along.z(), left.along.x()) - std::atan2(right.along.z(), right.along.x());
  EXPECT_GT(wrap, 0.7);
  EXPECT_GT(kStiffness * right.strain, 10.0) << "taut";
  const double work = kStiffness * kWidth * (left.strain - right.strain) * way;
  EXPECT_NEAR(simulation.energy().dissipated - dissipated, work, 0.02 * work);
  EXPECT_NEAR(std::log(left.strain / right.strain) / wrap, roller.friction, 0.02 * roller.friction);
}

// The last one is so long that a turn about another axis would have to be six times slower.
INSTANTIATE_TEST_SUITE_P(Rollers, RollerTest,
                         testing::Values(Roller{1.0, 0.02, 0.03, 0.01, 0.004},
                                         Roller{1.0, 0.02, 0.03, 0.1, 0.004},
                                         Roller{0.3, 0.02, 0.03, 0.1, 0.004},
                                         Roller{0.3, 0.01, 0.3, 0.1, 0.001}));

/// A strip slides off a smooth roller that turns.
TEST(SmoothRoller, DoesNoWorkByItsTurn) {
  constexpr int kAcross = 5;
  constexpr double kStep = 1e-3, kTime = 0.2;
  LinearFabric linear;
  linear.rigidity = 1e-5;
  linear.compression = 0.1;
  Scene scene = sheetScene(makeFabric(linear), 65, kAcross, 0.3, 0.03);
  scene.cloth.self_contact = false;
  scene.cloth.pose.position = Vec3(0.04, 0.0, 0.0156);
  Obstacle obstacle;
  obstacle.shape = Shape::Cylinder;
  obstacle.radius = 0.015;
  obstacle.length = 0.2;
  obstacle.friction = 0.0;
  obstacle.pose.orientation = lyingAlong(Vec3::UnitY());
  scene.obstacles.push_back(obstacle);
  scene.solver.time_step = kStep;
  scene.solver.minimizer.tolerance = 1e-3;
  scene.solver.minimizer.max_iterations = 5000;
  for (const double speed : {-70.0, -15.0, 40.0}) {  // rad/s
    Simulation simulation(scene);
    double turned = 0.0;
    for (double time = 0.0; time < kTime; time += kStep) {
      turned += speed * kStep;
      const Quat turn(Eigen::AngleAxisd(turned, Vec3::UnitY()));
      simulation.moveObstacle(0, {obstacle.pose.position, turn * obstacle.pose.orientation});
      simulation.step();
    }
    const EnergyReport energy = simulation.energy();
    EXPECT_GT(energy.dissipated, 5e-5) << "the strip slides";
    EXPECT_LT(std::abs(energy.work), 0.05 * energy.dissipated) << speed << " rad/s";
  }
}

}  // namespace
}  // namespace haptic_cloth::roller_test
