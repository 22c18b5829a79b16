/// A hand on a closed path. If forces follow from an energy, the path takes the same work as the path
/// backwards: that of damping. Half of the difference is what a hand gains in a cycle if the damping is small
/// enough. Fabrics without hysteresis, no friction, no gravity; borders are pinned, so the cloth comes back
/// to where it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/layers.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::closed_path_test {
namespace {

constexpr double kWidth = 24e-3;  // of the cloth [m]

/// Down, aside, up, and back in the air.
struct Path {
  Vec3 start, aside;   ///< at the depth of the path [m]
  double above = 0.0;  ///< height of its ends over that depth [m]
};

struct Felt {
  double pressing = 0.0;  ///< larger work of the ways down [J]
  double work = 0.0;      ///< on the whole path [J]
  double force = 0.0;     ///< largest on the way aside [N]
  double tick = 0.0;      ///< largest change of the force in a step there, over it [-]
};

Fabric softFabric() {
  LinearFabric linear;
  linear.areal_density = 0.2;
  linear.stiffness = 200.0;
  linear.compression = 1e-3;
  linear.rigidity = 1e-6;
  linear.shear_modulus = 50.0;
  return makeFabric(linear);
}

Felt follow(Scene scene, const ByParticle& place, const Path& path, bool backwards) {
  constexpr double kTime = 0.5;  // of each leg [s]
  for (Obstacle& obstacle : scene.obstacles) obstacle.friction = 0.0;
  ProbeOptions& probe = scene.probes[0];
  scene.cloth.self_friction = probe.friction = 0.0;
  scene.gravity.setZero();
  scene.air_damping = 5.0;
  scene.solver.minimizer.tolerance = 1e-3;
  scene.solver.minimizer.max_iterations = 1000;
  probe.coupling_stiffness = 4000.0;
  Simulation simulation(scene);
  placeCloth(simulation, place);
  Vec3 here = path.start, there = path.start + path.aside;
  if (backwards) std::swap(here, there);
  const Vec3 up(0.0, 0.0, path.above);
  const std::vector<Vec3> corners{here + up, here, there, there + up, here + up};
  const double h = scene.solver.time_step;
  Vec3 device = corners[0];
  for (int k = 0; k < 200; ++k) {
    simulation.setDevice(device, Vec3::Zero());
    simulation.step();
  }
  Felt felt;
  std::array<double, 4> work{};
  double last = 0.0;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    for (double time = h; time < kTime + 0.5 * h; time += h) {
      const double share = 0.5 * (1.0 - std::cos(EIGEN_PI * time / kTime));
      const Vec3 next = corners[leg] + share * (corners[leg + 1] - corners[leg]);
      simulation.setDevice(next, (next - device) / h);
      EXPECT_FALSE(simulation.step().failed);
      const Vec3 force = simulation.probe().force;
      work[leg] -= force.dot(next - device);
      device = next;
      if (leg == 1) {
        felt.tick = std::max(felt.tick, std::abs(force.norm() - last));
        felt.force = std::max(felt.force, force.norm());
      }
      last = force.norm();
    }
  }
  felt.pressing = std::max(work[0], -work[2]);
  felt.work = work[0] + work[1] + work[2] + work[3];
  felt.tick /= felt.force;
  return felt;
}

/// Both ways take the same work, within 0.1 % of the work of pressing, and not less than nothing; the force
/// changes by less than 2 % from step to step, as when the quality of the solver changes.
/// @return what was felt on the path
Felt expectAnEnergy(const std::string& name, const Scene& scene, const ByParticle& place, const Path& path) {
  constexpr double kShare = 1e-3, kTick = 0.02;
  const Felt there = follow(scene, place, path, false), back = follow(scene, place, path, true);
  const double pressing = std::max(there.pressing, back.pressing);
  record({"closed path, " + name, "difference of both ways / work of pressing, %", "finest", 0.0,
          100.0 * (there.work - back.work) / pressing, 0.0, 100.0});
  record({"closed path, " + name, "largest change of the force in a step, %", "finest", 0.0,
          100.0 * std::max(there.tick, back.tick), 0.0, 100.0});
  EXPECT_LT(std::abs(there.work - back.work), tolerance(kShare * pressing)) << name;
  EXPECT_GT(std::min(there.work, back.work), 0.0) << name;
  EXPECT_LT(std::max(there.tick, back.tick), tolerance(kTick)) << name;
  return there;
}

/// With weights of contact in a dent that follow its pressure, the difference is 6 % of the work on one
/// layer.
TEST(ClosedPath, TakesNoEnergyFromLayersOnAFloor) {
  for (const int count : {1, 2, 3}) {
    for (const double spacing : {4e-3, 2e-3}) {
      if (count == 3 && spacing < 4e-3) continue;  // slow; a coarse grid shows faults best
      const int side = static_cast<int>(std::lround(kWidth / spacing)) / 2 * 2 + 1;
      const Layers layers{std::vector<int>(count, side), side, spacing};
      Scene scene = layersScene(layers, softFabric());
      pinBorders(scene, layers);
      scene.obstacles = {Obstacle()};
      scene.probes[0].radius = 6e-3;
      const double t = scene.cloth.fabric.thickness, gaps = (count + 1) * t;
      std::vector<double> heights;
      for (int k = 1; k <= count; ++k) heights.push_back(k * t);
      const auto place = [&](int i, int j) { return placeInLayers(layers, heights, i, j); };
      Path path;
      path.start = place(side / 2, side / 2);
      path.start.z() = scene.probes[0].radius + 0.4 * gaps;
      path.aside = spacing * Vec3(0.5, 0.3, 0.0);
      path.above = 0.6 * gaps + t;
      expectAnEnergy(
          std::to_string(count) + " layers, spacing " + std::to_string(std::lround(1e3 * spacing)) + " mm",
          scene, place, path);
    }
  }
}

/// One layer between the probe and a floor, with up to 5 N: its gaps are closed, and nodes are inside the
/// floor. If they count as cloth that was put there, and is let out, they yield in each step, and 16 % of the
/// work are lost.
TEST(ClosedPath, TakesNoEnergyFromAHardPress) {
  constexpr int kSide = 13;
  constexpr double kSpacing = 2e-3, kLost = 0.02;
  const Layers layers{{kSide}, kSide, kSpacing};
  Scene scene = layersScene(layers, softFabric());
  pinBorders(scene, layers);
  scene.obstacles = {Obstacle()};
  scene.probes[0].radius = 6e-3;
  const double t = scene.cloth.fabric.thickness;
  const auto place = [&](int i, int j) { return placeInLayers(layers, {t}, i, j); };
  Path path;
  path.start = place(kSide / 2, kSide / 2);
  path.start.z() = scene.probes[0].radius - 1.6 * t;  // 1.3 thicknesses deep, the rest is the spring's
  path.aside = kSpacing * Vec3(0.5, 0.3, 0.0);
  path.above = 4.1 * t;
  const Felt felt = expectAnEnergy("hard press", scene, place, path);
  EXPECT_GT(felt.force, 3.0);
  EXPECT_LT(felt.work, tolerance(kLost * felt.pressing)) << "damping alone";
}

/// A sheet that lies on a box and hangs over its edge, pinned on both sides, under a probe.
class BoxEdge {
 public:
  /// @param spacing [m]  @param edge place of the edge [m]  @param yaw of the box [rad]
  BoxEdge(double spacing, double edge, double yaw) : spacing_(spacing), edge_(edge) {
    const int side = static_cast<int>(std::lround(kSize / spacing)) / 2 * 2 + 1;
    scene = sheetScene(softFabric(), side, side, (side - 1) * spacing, (side - 1) * spacing);
    middle = 0.5 * (side - 1) * spacing;
    setStrategy(scene, Strategy::Finest, 0);
    pin(scene, 0, 0, 0, side - 1);
    pin(scene, side - 1, side - 1, 0, side - 1);
    Obstacle box;
    box.shape = Shape::Box;
    box.size = Vec3(0.2, 0.2, 0.04);
    box.pose.orientation = Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
    box.pose.position = Vec3(edge, middle, -0.02) - box.pose.orientation * Vec3(0.1, 0.0, 0.0);
    scene.obstacles = {box};
    scene.probes[0].radius = 6e-3;
  }

  Vec3 place(int i, int j) const {
    constexpr double kIncline = 0.3;  // beyond the edge [rad]
    const double x = i * spacing_, beyond = std::max(0.0, x - edge_);
    return {std::min(x, edge_) + beyond * std::cos(kIncline), j * spacing_,
            scene.cloth.fabric.thickness - beyond * std::sin(kIncline)};
  }

  /// @param start of the path from the edge, and its way aside [cells]
  void expect(const std::string& name, const Vec3& start, const Vec3& aside) const {
    const double t = scene.cloth.fabric.thickness;
    Path path;
    path.above = 2.0 * t;
    path.start = Vec3(edge_, middle, scene.probes[0].radius + 0.8 * t) + spacing_ * start;
    path.aside = spacing_ * aside;
    expectAnEnergy(
        "edge of a box, " + name, scene, [this](int i, int j) { return place(i, j); }, path);
  }

  Scene scene;
  double middle = 0.0;  ///< of the sheet [m]

 private:
  static constexpr double kSize = 60e-3;  // of the sheet, about [m]
  double spacing_, edge_;
};

/// Samples that follow how the cloth rises along the edge, or how its normals turn, make the force step by 19
/// % on the way along it, and the work differ by 5 to 23 %.
TEST(ClosedPath, TakesNoEnergyFromTheEdgeOfABox) {
  const BoxEdge coarse(3.75e-3, 27e-3, 0.0);
  coarse.expect("along it", Vec3(0.0, 0.1, 0.0), Vec3(0.0, 0.5, 0.0));
  coarse.expect("across it", Vec3(-0.7, 0.1, 0.0), Vec3(0.9, 0.3, 0.0));
  const BoxEdge fine(2e-3, 30.4e-3, 0.0);
  fine.expect("far across it", Vec3(-2.0, 0.0, 0.0), Vec3(3.5, 0.0, 0.0));
  const BoxEdge slanting(2e-3, 30.4e-3, 0.4);
  slanting.expect("slanting", Vec3(-0.5, 0.0, 0.0), Vec3(1.0, 0.5, 0.0));
}

/// Two taut layers on a cylinder press on each other before a probe comes, nodes of one between those of the
/// other: unevenly within each cell. Criterion: a touch of less than 1 mN moves them by less than 1 % of
/// their thickness; middles of lines that press from this touch on would move them by 4 %.
TEST(ClosedPath, ALightTouchDoesNotMoveLayersOnACylinder) {
  constexpr int kColumns = 7, kRows = 11;
  constexpr double kSpacing = 5e-3, kRound = 24e-3, kStrain = 0.02;  // [m], [m], [-]
  const Layers layers{{kColumns, kColumns}, kRows, kSpacing, Vec3(0.45, 0.3, 0.0)};
  Fabric fabric = softFabric();
  Scene scene = layersScene(layers, fabric);
  for (const int first : {0, kColumns}) {
    for (const int column : {first, first + kColumns - 1}) pin(scene, column, column, 0, kRows - 1);
  }
  Obstacle cylinder;
  cylinder.shape = Shape::Cylinder;
  cylinder.radius = kRound;
  cylinder.length = 0.5;
  cylinder.pose.orientation = lyingAlong(Vec3::UnitY());
  cylinder.friction = 0.0;
  scene.obstacles = {cylinder};
  scene.cloth.self_friction = scene.probes[0].friction = 0.0;
  scene.probes[0].radius = 8e-3;
  quasiStatic(scene, 30.0, 1e-3, 1e-3);
  const double t = fabric.thickness, half = 0.5 * (kColumns - 1) * kSpacing;
  Simulation simulation(scene);
  placeCloth(simulation, [&](int i, int j) {
    const Vec3 flat = placeInLayers(layers, {0.97 * t, 1.95 * t}, i, j);
    const double radius = kRound + flat.z(), turn = (1.0 + kStrain) * (flat.x() - half) / (kRound + t);
    return Vec3(radius * std::sin(turn), flat.y(), radius * std::cos(turn));
  });
  Vec3 device(0.0, 0.5 * (kRows - 1) * kSpacing, kRound + scene.probes[0].radius + 3.2 * t);
  const auto hold = [&](int steps) {
    for (int k = 0; k < steps; ++k) {
      simulation.setDevice(device, Vec3::Zero());
      EXPECT_FALSE(simulation.step().failed);
    }
  };
  std::vector<Vec3> before, after;
  hold(1000);
  simulation.positions(before);
  for (int k = 0; simulation.probe().force.isZero(0.0); ++k) {
    ASSERT_LT(k, 5000) << "no touch";
    device.z() -= 2e-7;
    hold(1);
  }
  hold(50);
  simulation.positions(after);
  EXPECT_LT(simulation.probe().force.norm(), 1e-3);
  double moved = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k) moved = std::max(moved, (after[k] - before[k]).norm());
  record({"taut layers on a cylinder, lightly touched", "largest motion / thickness [%]", "finest", 0.0,
          100.0 * moved / t, 0.0, 100.0});
  EXPECT_LT(moved, tolerance(0.01 * t));
}

}  // namespace
}  // namespace haptic_cloth::closed_path_test
