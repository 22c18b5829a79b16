#include "support/scenes.h"

#include <algorithm>

namespace haptic_cloth {

Fabric makeFabric(const LinearFabric& linear) {
  Fabric fabric;
  fabric.name = "linear";
  fabric.source = "made up for a test";
  fabric.areal_density = linear.areal_density;
  fabric.thickness = linear.thickness;
  fabric.compression_ratio = linear.compression;
  fabric.compression = linear.measured;
  const Curve tensile(-1.0, 1.0, {-linear.compression * linear.stiffness, 0.0, linear.stiffness});
  fabric.tensile = {tensile, tensile};
  fabric.bending = {Curve::linear(linear.rigidity), Curve::linear(linear.rigidity)};
  fabric.shear = Curve::linear(linear.shear_modulus);
  return fabric;
}

Scene sheetScene(const Fabric& fabric, int warp_particles, int weft_particles, double length, double width) {
  Scene scene;
  scene.cloth.fabric = fabric;
  scene.cloth.particles = {warp_particles, weft_particles};
  scene.cloth.size = {length, width};
  scene.cloth.pose = Pose();
  scene.air_damping = 0.0;
  scene.solver.threads = 1;
  setStrategy(scene, Strategy::Finest, 0);
  return scene;
}

void hangDown(Scene& scene) {
  scene.cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitY()));
}

void pin(Scene& scene, int i0, int i1, int j0, int j1) { scene.cloth.pins.push_back({i0, i1, j0, j1}); }

void pinAllSides(Scene& scene) {
  const int i1 = scene.cloth.particles[kWarp] - 1, j1 = scene.cloth.particles[kWeft] - 1;
  pin(scene, 0, 0, 0, j1);
  pin(scene, i1, i1, 0, j1);
  pin(scene, 0, i1, 0, 0);
  pin(scene, 0, i1, j1, j1);
}

void quasiStatic(Scene& scene, double drag, double time_step, double tolerance) {
  scene.air_damping = drag;
  scene.solver.time_step = time_step;
  scene.solver.minimizer.tolerance = tolerance;
  scene.solver.minimizer.max_iterations = 5000;
  scene.solver.sleep_speed = 0.0;
}

void setStrategy(Scene& scene, Strategy strategy, int levels) {
  scene.adapt.strategy = strategy;
  scene.adapt.levels = levels;
}

std::string name(Strategy strategy) {
  switch (strategy) {
    case Strategy::Finest:
      return "finest";
    case Strategy::Coarsest:
      return "coarsest";
    case Strategy::Refine:
      return "refine";
    case Strategy::Coarsen:
      return "coarsen";
    case Strategy::Amrc:
      return "amrc";
  }
  return "unknown";
}

Scene boxDrape(int particles) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), particles, particles, 0.3, 0.3);
  setStrategy(scene, Strategy::Amrc, 2);
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3(0.15, 0.15, 0.1);
  box.pose.position = Vec3(0.0, 0.0, -0.055);  // top 5 mm below the cloth
  scene.obstacles = {box};
  scene.air_damping = 0.5;
  return scene;
}

Scene foldedSheet(int columns) {
  LinearFabric linear;
  linear.rigidity = 4e-6;
  linear.compression = 0.1;
  const int rows = (columns - 1) / 4 + 1;
  const double length = 0.0025 * (columns - 1);
  Scene scene = sheetScene(makeFabric(linear), columns, rows, length, 0.25 * length);
  setStrategy(scene, Strategy::Amrc, 2);
  pin(scene, 0, 0, 0, rows - 1);
  pin(scene, columns - 1, columns - 1, 0, rows - 1);
  scene.cloth.pins[0].velocity = Vec3(0.5 * length / 0.08, 0.0, 0.0);
  scene.cloth.pins[1].velocity = -scene.cloth.pins[0].velocity;
  return scene;
}

Scene capsuleOnStrip(Strategy strategy) {
  using Strip = CapsuleOnStrip;
  LinearFabric linear;
  linear.stiffness = Strip::kStiffness;
  linear.thickness = Strip::kThickness;
  Scene scene = sheetScene(makeFabric(linear), 81, 21, 2.0 * Strip::kHalfSpan, Strip::kWidth);
  setStrategy(scene, strategy, 2);
  pin(scene, 0, 0, 0, 20);
  pin(scene, 80, 80, 0, 20);
  scene.gravity.setZero();
  ProbeOptions& probe = scene.probes[0];
  probe.radius = Strip::kRadius;
  probe.length = 2.0 * Strip::kWidth;
  probe.friction = 0.0;
  probe.coupling_stiffness = 5000.0;
  quasiStatic(scene, 20.0, 2e-3, 1e-3);
  return scene;
}

Quat lyingAlong(const Vec3& axis) { return Quat::FromTwoVectors(Vec3::UnitZ(), axis); }

Settled settle(Simulation& simulation, double rest_speed, double max_time, const Vec3* device) {
  constexpr int kQuietSteps = 20;
  Settled settled;
  int quiet = 0;
  while (simulation.time() < max_time && quiet < kQuietSteps) {
    if (device != nullptr) simulation.setDevice(*device, Vec3::Zero());
    const StepReport report = simulation.step();
    ++settled.steps;
    settled.failed_steps += report.failed ? 1 : 0;
    settled.unconverged += report.minimizer.why == Termination::Converged ? 0 : 1;
    settled.max_penetration = std::max(settled.max_penetration, report.max_penetration);
    quiet = simulation.maxSpeed() < rest_speed ? quiet + 1 : 0;
  }
  settled.at_rest = quiet >= kQuietSteps;
  return settled;
}

Vec3 particle(const Simulation& simulation, int i, int j) {
  std::vector<Vec3> positions;
  simulation.positions(positions);
  return positions[j * simulation.scene().cloth.particles[kWarp] + i];
}

}  // namespace haptic_cloth
