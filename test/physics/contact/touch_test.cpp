/// Contact of the probe with the surface, not with the particles.
/// Criteria: a probe far thinner than a cell stays on its side of held cloth at any place and
/// speed; the first force is small, and the force never changes faster than the coupling spring
/// alone could change it; Coulomb's law on the probe; no point of any cell is deeper in a box than
/// the cloth is thick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::touch_test {
namespace {

constexpr double kSpacing = 0.004;

Scene heldSheet(Strategy strategy) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 41, 41, 40 * kSpacing, 40 * kSpacing);
  setStrategy(scene, strategy, 2);
  pinAllSides(scene);
  scene.air_damping = 1.0;
  return scene;
}

/// Moves the device along a line and calls `look` after each step.
template <class Look>
void drive(Simulation& simulation, const Vec3& from, const Vec3& to, double speed, const Look& look) {
  const double h = simulation.scene().solver.time_step;
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (speed * h))));
  const Vec3 velocity = (to - from) / (steps * h);
  for (int k = 1; k <= steps; ++k) {
    simulation.setDevice(from + k * h * velocity, velocity);
    ASSERT_FALSE(simulation.step().failed);
    look();
  }
}

void hold(Simulation& simulation, const Vec3& device, double time) {
  for (double t = 0.0; t < time; t += simulation.scene().solver.time_step) {
    simulation.setDevice(device, Vec3::Zero());
    ASSERT_FALSE(simulation.step().failed);
  }
}

struct Stab {
  std::string label;
  Strategy strategy;
  double x, y;   ///< in spacings from the middle particle
  double speed;  ///< [m/s]
  int side;      ///< 1: from above, -1: from below
};

class ThinProbe : public testing::TestWithParam<Stab> {};

TEST_P(ThinProbe, DoesNotGetThrough) {
  const Stab& stab = GetParam();
  Scene scene = heldSheet(stab.strategy);
  scene.probes[0].radius = 0.25 * kSpacing;
  Simulation simulation(scene);
  const Vec3 out = stab.side * Vec3::UnitZ(), place = kSpacing * Vec3(stab.x, stab.y, 0.0);
  const Vec3 start = place + 0.01 * out, end = place - 0.03 * out;
  hold(simulation, start, 0.002);
  bool touched = false, lost = false;
  drive(simulation, start, end, stab.speed, [&] {
    const bool contact = simulation.probe().contact;
    touched = touched || contact;
    lost = lost || (touched && !contact && simulation.probe().force.dot(out) < 0.0);
  });
  hold(simulation, end, 0.05);
  // The probe is pressed 30 mm deep by a spring of 400 N/m, on a membrane that yields by less. A
  // probe that had passed through would have no force and stand at its device.
  const ProbeReport probe = simulation.probe();
  EXPECT_TRUE(touched);
  EXPECT_FALSE(lost);
  EXPECT_TRUE(probe.contact);
  EXPECT_GT(probe.force.dot(out), 0.1);
  EXPECT_GT((probe.proxy - probe.device).dot(out), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Stabs, ThinProbe,
                         testing::Values(Stab{"slow_particle", Strategy::Finest, 0.0, 0.0, 0.2, 1},
                                         Stab{"fast_particle", Strategy::Finest, 0.0, 0.0, 5.0, 1},
                                         Stab{"fast_edge", Strategy::Finest, 0.5, 0.0, 5.0, -1},
                                         Stab{"fast_cell", Strategy::Finest, 3.5, -2.5, 5.0, 1},
                                         Stab{"fast_anywhere", Strategy::Finest, 7.31, 4.73, 5.0, -1},
                                         Stab{"fast_near_the_pins", Strategy::Finest, 17.6, -18.2, 5.0, 1},
                                         Stab{"amrc_slow_anywhere", Strategy::Amrc, 5.83, -3.21, 0.2, 1},
                                         Stab{"amrc_fast_anywhere", Strategy::Amrc, -6.27, 8.64, 5.0, 1},
                                         Stab{"amrc_fast_from_below", Strategy::Amrc, 2.5, 2.5, 5.0, -1},
                                         Stab{"amrc_faster", Strategy::Amrc, 1.3, 0.4, 10.0, 1}),
                         [](const auto& info) { return info.param.label; });

/// Height of a corner of a sheet that falls onto a box for 0.3 s [m]. @param pressed a probe as thin as a pin
/// presses it onto the box by a spring that is compressed by 6 mm
double fallenCorner(bool pressed) {
  Scene scene = boxDrape(33);
  scene.probes[0].radius = 0.0005;
  scene.probes[0].path = {{0.0, Vec3(0.01, 0.007, 0.004)}, {0.05, Vec3(0.01, 0.007, -0.011)}};
  if (!pressed) scene.probes[0].path.clear();
  Simulation simulation(scene);
  int undone = 0;  // steps that ended far from their solution
  while (simulation.time() < 0.3) {
    if (pressed) followPaths(simulation, 1);
    if (simulation.step().minimizer.residual > 1.0) ++undone;
  }
  EXPECT_LE(undone, 3);
  if (pressed) {
    const ProbeReport probe = simulation.probe();
    const Vec3 spring = scene.probes[0].coupling_stiffness * (probe.proxy - probe.device);
    EXPECT_GT(spring.norm(), 2.0);
    EXPECT_LT((probe.force - spring).norm(), tolerance(0.01) * spring.norm());
  }
  std::vector<Vec3> positions;
  simulation.positions(positions);
  return positions.front().z();
}

// Whatever presses on one place of the cloth, the rest falls: pressed cloth is lower by no less than nine
// tenths of what it is without the probe, whose place is the first to lie on the box. The spring carries all
// of the force once the probe rests, by Newton's third law.
TEST(PinnedDown, DoesNotHoldUpTheRest) {
  const double free = fallenCorner(false), pressed = fallenCorner(true);
  EXPECT_LT(free, -0.03);
  EXPECT_LT(pressed, 0.9 * free);
}

class FirstTouch : public testing::TestWithParam<Strategy> {};

TEST_P(FirstTouch, BeginsWithoutAJump) {
  const Scene scene = heldSheet(GetParam());
  Simulation simulation(scene);
  const ProbeOptions& options = scene.probes[0];
  constexpr double kSpeed = 0.1;
  const Vec3 start(0.0013, 0.0007, options.radius + 0.004), end = start - Vec3(0.0, 0.0, 0.014);
  hold(simulation, start, 0.3);
  std::vector<double> forces;
  drive(simulation, start, end, kSpeed, [&] { forces.push_back(simulation.probe().force.z()); });
  const auto first = std::find_if(forces.begin(), forces.end(), [](double force) { return force > 0.0; });
  ASSERT_NE(first, forces.end());
  double largest = 0.0;
  for (auto next = first + 1; next != forces.end(); ++next)
    largest = std::max(largest, std::abs(*next - *(next - 1)));
  // The spring changes by k v h in a step; the damper adds its part while the proxy is slowed down.
  const double h = scene.solver.time_step, spring = options.coupling_stiffness * kSpeed * h;
  const double damper = options.coupling_damping * kSpeed;
  record({"probe meets the cloth at 0.1 m/s", "first force [mN]", name(GetParam()), kSpeed, 1e3 * *first, 0.0,
          1e3 * (spring + damper)});
  record({"probe meets the cloth at 0.1 m/s", "largest change in 1 ms [mN]", name(GetParam()), kSpeed,
          1e3 * largest, 0.0, 1e3 * (spring + damper)});
  EXPECT_LT(*first, tolerance(spring));
  EXPECT_LT(largest, tolerance(spring + damper));
}

INSTANTIATE_TEST_SUITE_P(Strategies, FirstTouch, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

struct Rub {
  std::string label;
  Strategy strategy;
  double friction;
};

class RubbingProbe : public testing::TestWithParam<Rub> {};

/// Held sheet on a table, with a probe that presses on it.
Scene onTable(const Rub& rub) {
  Scene scene = heldSheet(rub.strategy);
  Obstacle table;
  table.shape = Shape::Plane;
  table.pose.position.z() = -scene.cloth.fabric.thickness;
  table.friction = 1.0;
  scene.obstacles.push_back(table);
  scene.probes[0].friction = rub.friction;
  return scene;
}

TEST_P(RubbingProbe, SticksThenSlidesAtCoulombsRatio) {
  const Rub& rub = GetParam();
  Simulation simulation(onTable(rub));
  const ProbeOptions& options = simulation.scene().probes[0];
  const Vec3 above(0.0011, 0.0006, options.radius + 0.003);
  const Vec3 pressed = above - Vec3(0.0, 0.0, 0.006);
  hold(simulation, above, 0.05);
  drive(simulation, above, pressed, 0.05, [] {});
  hold(simulation, pressed, 0.1);
  const double normal = simulation.probe().force.z();
  ASSERT_GT(normal, 0.5);
  // At half of the slip force the proxy creeps by less than the cloth itself may yield.
  const Vec3 start = simulation.probe().proxy;
  const double slip = rub.friction * normal / options.coupling_stiffness;
  const Vec3 half = pressed + Vec3(0.5 * slip, 0.0, 0.0);
  drive(simulation, pressed, half, 0.02, [] {});
  const double crept = (simulation.probe().proxy - start).x();
  EXPECT_LT(crept, 0.1 * 0.5 * slip);
  // At ten times that distance it slides. The device moves on, so its force is that of sliding.
  const Vec3 far = pressed + Vec3(10.0 * slip, 0.0, 0.0);
  double ratio = 0.0;
  int count = 0;
  drive(simulation, half, far, 0.02, [&] {
    const Vec3 force = simulation.probe().force;
    if ((simulation.probe().device - pressed).x() < 5.0 * slip) return;
    ratio += -force.x() / force.z();
    ++count;
  });
  ratio /= count;
  record({"probe drawn over cloth on a table", "tangential / normal force", rub.label, rub.friction, ratio,
          rub.friction, rub.friction});
  EXPECT_NEAR(ratio, rub.friction, tolerance(0.05 * rub.friction));
}

INSTANTIATE_TEST_SUITE_P(Rubs, RubbingProbe,
                         testing::Values(Rub{"finest", Strategy::Finest, 0.2},
                                         Rub{"amrc", Strategy::Amrc, 0.2},
                                         Rub{"amrc_rough", Strategy::Amrc, 0.6}),
                         [](const auto& info) { return info.param.label; });

/// Depth of the deepest point of the surface in a box [m]; each cell is sampled at 9 × 9 points.
double deepestPoint(const Simulation& simulation, const Obstacle& box) {
  std::vector<Vec3> positions;
  std::vector<CellView> cells;
  simulation.positions(positions);
  simulation.cells(cells);
  double deepest = 0.0;
  for (const CellView& cell : cells) {
    for (int j = 0; j <= 8; ++j) {
      for (int i = 0; i <= 8; ++i) {
        const double u = i / 8.0, v = j / 8.0;
        const Vec3 x = (1 - u) * (1 - v) * positions[cell.particles[0]] +
                       u * (1 - v) * positions[cell.particles[1]] +
                       (1 - u) * v * positions[cell.particles[2]] + u * v * positions[cell.particles[3]];
        const Vec3 inside = 0.5 * box.size - (x - box.pose.position).cwiseAbs();
        deepest = std::max(deepest, inside.minCoeff());
      }
    }
  }
  return deepest;
}

class SharpBox : public testing::TestWithParam<Strategy> {};

TEST_P(SharpBox, DoesNotCutThroughCells) {
  Scene scene = boxDrape(33);
  setStrategy(scene, GetParam(), 2);
  scene.air_damping = 5.0;
  Simulation simulation(scene);
  double deepest = 0.0;
  while (simulation.time() < 0.8) {
    for (int k = 0; k < 10; ++k) ASSERT_FALSE(simulation.step().failed);
    deepest = std::max(deepest, deepestPoint(simulation, scene.obstacles[0]));
  }
  const double thickness = scene.cloth.fabric.thickness;
  record({"drape over a sharp box", "deepest point of the surface [mm]", name(GetParam()), 0.0, 1e3 * deepest,
          0.0, 1e3 * thickness});
  EXPECT_LT(deepest, tolerance(thickness));
}

INSTANTIATE_TEST_SUITE_P(Strategies, SharpBox,
                         testing::Values(Strategy::Finest, Strategy::Amrc, Strategy::Coarsest),
                         [](const auto& info) { return name(info.param); });

}  // namespace
}  // namespace haptic_cloth::touch_test
