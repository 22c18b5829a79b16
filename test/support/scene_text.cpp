#include "support/scene_text.h"

#include <algorithm>
#include <sstream>

#include "scene/scene_options.h"
#include "shape/shapes.h"
#include "support/scenes.h"

namespace haptic_cloth {
namespace {

std::ostream& operator<<(std::ostream& out, const Vec3& v) {
  return out << '[' << v.x() << ", " << v.y() << ", " << v.z() << ']';
}

std::ostream& operator<<(std::ostream& out, const Quat& q) {
  return out << '[' << q.x() << ", " << q.y() << ", " << q.z() << ", " << q.w() << ']';
}

void writePath(std::ostream& out, const std::vector<PathPoint>& path) {
  out << "path: [";
  for (const PathPoint& row : path) {
    const Vec3& x = row.position;
    out << (&row == &path.front() ? "" : ",\n      ") << '[' << row.time << ", " << x.x() << ", " << x.y()
        << ", " << x.z() << ']';
  }
  out << ']';
}

void writeCloth(std::ostream& out, const ClothOptions& cloth, const std::string& fabric_file) {
  out << "cloth:\n  particles: [" << cloth.particles[0] << ", " << cloth.particles[1] << "]\n  size: ["
      << cloth.size[0] << ", " << cloth.size[1] << "]\n  position: " << cloth.pose.position
      << "\n  orientation: " << cloth.pose.orientation << "\n  fabric: " << fabric_file << "\n  pins: [";
  for (const Pin& pin : cloth.pins) {
    Pin copy = pin;  // rows point to members that could be written
    out << (&pin == &cloth.pins.front() ? "" : ", ") << "{particles: [[" << pin.i0 << ", " << pin.i1 << "], ["
        << pin.j0 << ", " << pin.j1 << "]]";
    for (const Option& option : optionsOf(copy)) {
      if (option.key != "particles" && pin.moves()) out << ", " << option.key << ": " << valueText(option);
    }
    out << '}';
  }
  out << "]\n  self_contact: " << (cloth.self_contact ? "true" : "false")
      << "\n  self_friction: " << cloth.self_friction << '\n';
}

void writeObstacle(std::ostream& out, const Obstacle& obstacle) {
  Obstacle copy = obstacle;  // rows point to members that could be written
  out << "  - {shape: " << nameOf(shapeNames(), obstacle.shape);
  if (!obstacle.name.empty()) out << ", name: " << obstacle.name;
  for (const Option& option : optionsOf(copy)) {
    const std::vector<std::string> dimensions = dimensionsOf(obstacle.shape);
    if (std::count(dimensions.begin(), dimensions.end(), option.key) > 0) {
      out << ", " << option.key << ": " << valueText(option);
    }
  }
  out << ", position: " << obstacle.pose.position << ", orientation: " << obstacle.pose.orientation
      << ", friction: " << obstacle.friction;
  if (!obstacle.path.empty()) writePath(out << ",\n      ", obstacle.path);
  out << "}\n";
}

void writeProbe(std::ostream& out, const ProbeOptions& probe) {
  out << "  " << probe.name << ":\n    {shape: " << (probe.length > 0.0 ? "capsule" : "sphere")
      << ", radius: " << probe.radius;
  if (probe.length > 0.0) out << ", length: " << probe.length;
  out << ", friction: " << probe.friction << ", coupling_stiffness: " << probe.coupling_stiffness
      << ", coupling_damping: " << probe.coupling_damping << ", orientation: " << probe.orientation;
  if (!probe.path.empty()) writePath(out << ",\n     ", probe.path);
  if (!probe.grasp.empty()) {
    out << ",\n     grasp: [";
    for (const auto& [from, to] : probe.grasp) {
      out << (from == probe.grasp.front()[0] ? "" : ", ") << '[' << from << ", " << to << ']';
    }
    out << ']';
  }
  out << "}\n";
}

void writeOptions(std::ostream& out, const Scene& scene) {
  const SolverOptions& solver = scene.solver;
  out << "solver: {time_step: " << solver.time_step
      << ", integrator: " << nameOf(integratorNames(), solver.integrator)
      << ", cost: " << nameOf(costNames(), solver.cost)
      << ", preconditioner: " << nameOf(preconditionerNames(), solver.minimizer.preconditioner)
      << ", tolerance: " << solver.minimizer.tolerance
      << ", max_iterations: " << solver.minimizer.max_iterations
      << ", time_budget: " << solver.minimizer.time_budget << ", sleep_speed: " << solver.sleep_speed
      << ", threads: " << solver.threads << "}\n";
  const AdaptOptions& adapt = scene.adapt;
  out << "adapt: {strategy: " << name(adapt.strategy);
  if (adapt.strategy == Strategy::Amrc) out << ", start: " << nameOf(startNames(), adapt.start);
  out << ", levels: " << adapt.levels << ", interval: " << adapt.interval
      << ", refine_above: " << adapt.refine_above << ", coarsen_below: " << adapt.coarsen_below
      << ", refine_above_strain: " << adapt.refine_above_strain
      << ", coarsen_below_strain: " << adapt.coarsen_below_strain
      << ", far_angle_factor: " << adapt.far_angle_factor
      << ", far_strain_factor: " << adapt.far_strain_factor << ", near_reach: " << adapt.near_reach
      << ", near_load: " << adapt.near_load << ", minimum_age: " << adapt.minimum_age
      << "}\nstop: {time: " << scene.stop.time << ", rest_speed: " << scene.stop.rest_speed << "}\n";
}

}  // namespace

std::string sceneText(const Scene& scene, const std::string& fabric_file) {
  std::ostringstream out;
  out.precision(17);
  writeCloth(out, scene.cloth, fabric_file);
  out << "gravity: " << scene.gravity << "\nair_damping: " << scene.air_damping << '\n';
  if (!scene.obstacles.empty()) out << "obstacles:\n";
  for (const Obstacle& obstacle : scene.obstacles) writeObstacle(out, obstacle);
  out << "probes:\n";
  for (const ProbeOptions& probe : scene.probes) writeProbe(out, probe);
  writeOptions(out, scene);
  return out.str();
}

}  // namespace haptic_cloth
