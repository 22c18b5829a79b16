#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fabric/fabric_search.h"
#include "fabric/yaml_reader.h"
#include "haptic_cloth/scene.h"
#include "sim/scene_names.h"
#include "sim/scene_validation.h"

namespace haptic_cloth {
namespace {

constexpr double kAlmostUnit = 1e-3;  ///< a norm this close to 1 is rounded, not wrong [-]

/// Reads a quaternion x y z w and normalises it.
Quat readOrientation(const YamlValue& value) {
  const auto [x, y, z, w] = value.numbers<4>();
  const Quat orientation(w, x, y, z);
  const double norm = orientation.norm();
  if (!(norm > 0.0)) value.fail("must not be zero: a unit quaternion x y z w");
  if (!(std::abs(norm - 1.0) <= kAlmostUnit)) value.fail("must be a unit quaternion x y z w");
  return orientation.normalized();
}

void readPose(const YamlMap& map, Pose& pose) {
  map.read("position", pose.position);
  if (const auto orientation = map.find("orientation")) pose.orientation = readOrientation(*orientation);
}

/// Particles of a named pin: "corner_01" is the first particle along x and the last along y,
/// "edge_x1" all particles that are last along x.
ParticleRange namedPin(const YamlValue& value, int last_i, int last_j) {
  const std::vector<std::pair<std::string, ParticleRange>> names{
      {"corner_00", {0, 0, 0, 0}},           {"corner_10", {last_i, last_i, 0, 0}},
      {"corner_01", {0, 0, last_j, last_j}}, {"corner_11", {last_i, last_i, last_j, last_j}},
      {"edge_x0", {0, 0, 0, last_j}},        {"edge_x1", {last_i, last_i, 0, last_j}},
      {"edge_y0", {0, last_i, 0, 0}},        {"edge_y1", {0, last_i, last_j, last_j}}};
  return value.choice(names);
}

ParticleRange readPin(const YamlValue& value, const std::array<int, 2>& particles) {
  if (!value.isMap()) {
    // Counts below 1 are refused later; here they must not overflow.
    return namedPin(value, std::max(particles[0], 1) - 1, std::max(particles[1], 1) - 1);
  }
  const YamlMap map(value, {"particles"});
  const std::vector<YamlValue> ranges = map.require("particles").list(2, "ranges [first, last]");
  const auto [i0, i1] = ranges[0].integers<2>();
  const auto [j0, j1] = ranges[1].integers<2>();
  return {i0, i1, j0, j1};
}

Fabric readFabric(const YamlValue& value, const std::string& base_directory) {
  const std::string name = value.text();
  const std::string file = findFabric(name, base_directory);
  if (file.empty()) {
    value.fail("must be a fabric's name or the path of a .yaml file; no such file: " +
               joined(fabricCandidates(name, base_directory)));
  }
  return loadFabric(file);
}

void readCloth(const YamlMap& root, const std::string& base_directory, ClothOptions& cloth) {
  const YamlValue value = root.require("cloth", "is required, with cloth.fabric in it");
  const YamlMap map(value, {"particles", "size", "position", "orientation", "fabric", "pins"});
  if (const auto particles = map.find("particles")) cloth.particles = particles->integers<2>();
  if (const auto size = map.find("size")) cloth.size = size->numbers<2>();
  readPose(map, cloth.pose);
  cloth.fabric = readFabric(map.require("fabric"), base_directory);
  if (const auto pins = map.find("pins")) {
    for (const YamlValue& pin : pins->list()) cloth.pins.push_back(readPin(pin, cloth.particles));
  }
}

/// Keys of one shape; all are required.
std::vector<std::string> shapeKeys(Shape shape) {
  switch (shape) {
    case Shape::Box:
      return {"size"};
    case Shape::Sphere:
      return {"radius"};
    case Shape::Cylinder:
    case Shape::Capsule:
      return {"radius", "length"};
    case Shape::Plane:
      break;
  }
  return {};
}

std::vector<PathPoint> readPath(const YamlValue& value) {
  std::vector<PathPoint> path;
  for (const YamlValue& row : value.list()) {
    const auto [t, x, y, z] = row.numbers<4>();
    path.push_back({t, Vec3(x, y, z)});
  }
  return path;
}

Obstacle readObstacle(const YamlValue& value) {
  Obstacle obstacle;
  const YamlMap any(
      value, {"name", "shape", "size", "radius", "length", "position", "orientation", "friction", "path"});
  obstacle.shape = any.require("shape").choice(shapeNames());

  const std::vector<std::string> own = shapeKeys(obstacle.shape);
  std::vector<std::string> known{"name", "shape", "position", "orientation", "friction", "path"};
  known.insert(known.end(), own.begin(), own.end());
  const YamlMap map(value, known);
  for (const std::string& key : own) map.require(key, "is required for this shape");
  if (obstacle.shape == Shape::Box) {
    map.read("size", obstacle.size);
  } else if (!own.empty()) {
    map.read("radius", obstacle.radius);
    if (obstacle.shape != Shape::Sphere) map.read("length", obstacle.length);
  }
  if (const auto name = map.find("name")) obstacle.name = name->text();
  if (const auto path = map.find("path")) obstacle.path = readPath(*path);
  readPose(map, obstacle.pose);
  map.read("friction", obstacle.friction);
  return obstacle;
}

void readProbe(const YamlValue& value, ProbeOptions& probe) {
  const YamlMap map(value, {"shape", "radius", "length", "friction", "coupling_stiffness", "coupling_damping",
                            "path", "orientation", "grasp"});
  Shape shape = Shape::Sphere;
  map.readChoice<Shape>("shape", shape, {{"sphere", Shape::Sphere}, {"capsule", Shape::Capsule}});
  map.read("radius", probe.radius);
  if (shape == Shape::Capsule) {
    map.require("length", "is required for this shape");
    map.read("length", probe.length);
  } else if (const auto length = map.find("length")) {
    length->fail("is for shape: capsule");
  }
  map.read("friction", probe.friction);
  map.read("coupling_stiffness", probe.coupling_stiffness);
  map.read("coupling_damping", probe.coupling_damping);
  if (const auto path = map.find("path")) probe.path = readPath(*path);
  if (const auto orientation = map.find("orientation")) probe.orientation = readOrientation(*orientation);
  const auto grasp = map.find("grasp");
  if (!grasp) return;
  for (const YamlValue& times : grasp->list()) probe.grasp.push_back(times.numbers<2>());
}

/// Reads one probe from `probe`, or several by name from `probes` with `probe` as their common
/// part. The default radius is never smaller than the cloth allows.
void readProbes(const YamlMap& root, const ClothOptions& cloth, std::vector<ProbeOptions>& probes) {
  probes.front().radius = std::max(probes.front().radius, smallestProbeRadius(cloth));
  const auto one = root.find("probe"), several = root.find("probes");
  if (one) readProbe(*one, probes.front());
  if (!several) return;
  const ProbeOptions common = probes.front();
  probes.clear();
  for (const auto& [name, value] : several->entries()) {
    probes.push_back(common);
    probes.back().name = name;
    readProbe(value, probes.back());
  }
}

void readSolver(const YamlValue& value, SolverOptions& solver) {
  const YamlMap map(value, {"time_step", "integrator", "cost", "preconditioner", "tolerance",
                            "max_iterations", "time_budget", "sleep_speed", "threads"});
  map.read("time_step", solver.time_step);
  map.readChoice("integrator", solver.integrator, integratorNames());
  map.readChoice("cost", solver.cost, costNames());
  map.readChoice("preconditioner", solver.minimizer.preconditioner, preconditionerNames());
  map.read("tolerance", solver.minimizer.tolerance);
  map.read("max_iterations", solver.minimizer.max_iterations);
  map.read("time_budget", solver.minimizer.time_budget);
  map.read("sleep_speed", solver.sleep_speed);
  map.read("threads", solver.threads);
}

void readAdapt(const YamlValue& value, AdaptOptions& adapt) {
  const YamlMap map(value, {"strategy", "start", "levels", "interval", "refine_above", "coarsen_below",
                            "refine_above_strain", "coarsen_below_strain", "minimum_age"});
  map.readChoice("strategy", adapt.strategy, strategyNames());
  map.readChoice("start", adapt.start, startNames());
  map.read("levels", adapt.levels);
  map.read("interval", adapt.interval);
  map.read("refine_above", adapt.refine_above);
  map.read("coarsen_below", adapt.coarsen_below);
  map.read("refine_above_strain", adapt.refine_above_strain);
  map.read("coarsen_below_strain", adapt.coarsen_below_strain);
  map.read("minimum_age", adapt.minimum_age);
}

void readStop(const YamlValue& value, StopOptions& stop) {
  const YamlMap map(value, {"time", "rest_speed"});
  map.read("time", stop.time);
  map.read("rest_speed", stop.rest_speed);
}

Scene readScene(YamlDocument document, const std::string& base_directory,
                const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) document.override(assignment);
  const YamlMap root(document.root(), sceneKeys());
  Scene scene;
  readCloth(root, base_directory, scene.cloth);
  root.read("gravity", scene.gravity);
  root.read("air_damping", scene.air_damping);
  if (const auto obstacles = root.find("obstacles")) {
    for (const YamlValue& obstacle : obstacles->list()) scene.obstacles.push_back(readObstacle(obstacle));
  }
  readProbes(root, scene.cloth, scene.probes);
  if (const auto solver = root.find("solver")) readSolver(*solver, scene.solver);
  if (const auto adapt = root.find("adapt")) readAdapt(*adapt, scene.adapt);
  if (const auto stop = root.find("stop")) readStop(*stop, scene.stop);
  checkScene(scene, [&](const std::string& key) { return document.locate(key); });
  return scene;
}

}  // namespace

Scene loadScene(const std::string& file, const std::vector<std::string>& overrides) {
  return readScene(YamlDocument::fromFile(file), std::filesystem::path(file).parent_path().string(),
                   overrides);
}

Scene parseScene(const std::string& yaml, const std::string& origin, const std::string& base_directory,
                 const std::vector<std::string>& overrides) {
  return readScene(YamlDocument::fromText(yaml, origin), base_directory, overrides);
}

Vec3 pathPosition(const std::vector<PathPoint>& path, double time) {
  if (path.empty()) return Vec3::Zero();
  const auto after = std::upper_bound(path.begin(), path.end(), time,
                                      [](double t, const PathPoint& point) { return t < point.time; });
  if (after == path.begin()) return path.front().position;
  if (after == path.end()) return path.back().position;
  const PathPoint& before = *(after - 1);
  const double part = (time - before.time) / (after->time - before.time);
  return before.position + part * (after->position - before.position);
}

}  // namespace haptic_cloth
