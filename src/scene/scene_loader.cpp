#include <algorithm>
#include <filesystem>

#include "fabric/fabric_search.h"
#include "fabric/yaml_reader.h"
#include "haptic_cloth/scene.h"
#include "scene/scene_options.h"
#include "scene/scene_validation.h"
#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

/// Reads a quaternion x y z w and normalises it.
Quat readOrientation(const YamlValue& value) {
  const auto [x, y, z, w] = value.numbers<4>();
  const Quat orientation(w, x, y, z);
  if (!(orientation.norm() > 0.0)) value.fail("must not be zero: a unit quaternion x y z w");
  if (!isRotation(orientation)) value.fail("must be a unit quaternion x y z w");
  return orientation.normalized();
}

/// Reads a value into the member of its option.
struct Reader {
  const YamlValue& value;

  void operator()(const Numbers<double>& numbers) const {
    if (numbers.count == 1) {
      *numbers.first = value.number();
      return;
    }
    const std::vector<YamlValue> entries = value.list(numbers.count, "numbers");
    for (std::size_t k = 0; k < numbers.count; ++k) numbers.first[k] = entries[k].number();
  }
  void operator()(const Numbers<int>& numbers) const {
    if (numbers.count == 1) {
      *numbers.first = value.integer();
      return;
    }
    const std::vector<YamlValue> entries = value.list(numbers.count, "integers");
    for (std::size_t k = 0; k < numbers.count; ++k) numbers.first[k] = entries[k].integer();
  }
  void operator()(Quat* orientation) const { *orientation = readOrientation(value); }
  void operator()(bool* flag) const { *flag = value.choice<bool>({{"true", true}, {"false", false}}); }
  void operator()(std::string* text) const { *text = value.text(); }
  void operator()(const Choice& choice) const {
    Names<std::size_t> names;
    for (const std::string& name : choice.names) names.emplace_back(name, names.size());
    choice.set(value.choice(names));
  }
  void operator()(const OwnReader&) const {}
};

/// Reads the options whose keys the map has, except those with a reader of their own.
void readOptions(const YamlMap& map, const Options& options) {
  for (const Option& option : options) {
    if (const auto value = map.find(option.key)) std::visit(Reader{*value}, option.field);
  }
}

/// Reads a map that holds only options.
void readGroup(const YamlMap& root, const std::string& key, const Options& options) {
  if (const auto value = root.find(key)) readOptions(YamlMap(*value, keysOf(options)), options);
}

/// Particles of a named pin: "corner_01" is the first particle along x and the last along y,
/// "edge_x1" all particles that are last along x.
Pin namedPin(const YamlValue& value, int last_i, int last_j) {
  const std::vector<std::pair<std::string, Pin>> names{
      {"corner_00", {0, 0, 0, 0}},           {"corner_10", {last_i, last_i, 0, 0}},
      {"corner_01", {0, 0, last_j, last_j}}, {"corner_11", {last_i, last_i, last_j, last_j}},
      {"edge_x0", {0, 0, 0, last_j}},        {"edge_x1", {last_i, last_i, 0, last_j}},
      {"edge_y0", {0, last_i, 0, 0}},        {"edge_y1", {0, last_i, last_j, last_j}}};
  return value.choice(names);
}

Pin readPin(const YamlValue& value, const std::array<int, 2>& particles) {
  // Counts below 1 are refused later; here they must not overflow.
  const int last_i = std::max(particles[0], 1) - 1, last_j = std::max(particles[1], 1) - 1;
  if (!value.isMap()) return namedPin(value, last_i, last_j);
  Pin pin{};
  const Options options = optionsOf(pin);
  const YamlMap map(value, keysOf(options));
  const YamlValue range = map.require("particles");
  if (range.isList()) {
    const std::vector<YamlValue> ranges = range.list(2, "ranges [first, last]");
    const auto [i0, i1] = ranges[0].integers<2>();
    const auto [j0, j1] = ranges[1].integers<2>();
    pin = {i0, i1, j0, j1};
  } else {
    pin = namedPin(range, last_i, last_j);
  }
  readOptions(map, options);
  return pin;
}

Fabric readFabric(const YamlValue& value, const std::string& base_directory) {
  const std::string name = value.text();
  const std::string file = findFabric(name, base_directory);
  if (file.empty()) {
    value.fail("must be a fabric's name or the path of a .yaml file; no such file: " +
               joined(fabricCandidates(name, base_directory)) +
               "; names: " + joined(fabricNames(base_directory)));
  }
  return loadFabric(file);
}

void readCloth(const YamlMap& root, const std::string& base_directory, ClothOptions& cloth) {
  const YamlValue value = root.require("cloth", "is required, with cloth.fabric in it");
  const Options options = optionsOf(cloth);
  const YamlMap map(value, keysOf(options));
  readOptions(map, options);
  cloth.fabric = readFabric(map.require("fabric"), base_directory);
  if (const auto pins = map.find("pins")) {
    for (const YamlValue& pin : pins->list()) cloth.pins.push_back(readPin(pin, cloth.particles));
  }
}

std::vector<PathPoint> readPath(const YamlValue& value) {
  std::vector<PathPoint> path;
  for (const YamlValue& row : value.list()) {
    const auto [t, x, y, z] = row.numbers<4>();
    path.push_back({t, Vec3(x, y, z)});
  }
  return path;
}

void readObstacle(const YamlValue& value, Obstacle& obstacle) {
  const YamlMap any(value, keysOf(optionsOf(obstacle)));
  obstacle.shape = any.require("shape").choice(shapeNames());

  const Options options = ownOptions(obstacle);
  const YamlMap map(value, keysOf(options));
  for (const std::string& key : dimensionsOf(obstacle.shape)) map.require(key, "is required for this shape");
  readOptions(map, options);
  if (const auto name = map.find("name")) obstacle.name = name->text();
  if (const auto path = map.find("path")) obstacle.path = readPath(*path);
  if (!obstacle.path.empty() && !map.find("position"))
    obstacle.pose.position = pathPosition(obstacle.path, 0.0);
}

/// @param probe in: what is common to all probes
void readProbe(const YamlValue& value, ProbeOptions& probe) {
  const Options options = optionsOf(probe);
  const YamlMap map(value, keysOf(options));
  Shape shape = probe.length > 0.0 ? Shape::Capsule : Shape::Sphere;
  if (const auto named = map.find("shape")) {
    shape = named->choice<Shape>({{"sphere", Shape::Sphere}, {"capsule", Shape::Capsule}});
  }
  if (shape == Shape::Capsule && probe.length == 0.0) map.require("length", "is required for this shape");
  if (shape == Shape::Sphere) {
    if (const auto length = map.find("length")) length->fail("is for shape: capsule");
    probe.length = 0.0;
  }
  readOptions(map, options);
  if (const auto path = map.find("path")) probe.path = readPath(*path);
  const auto grasp = map.find("grasp");
  if (!grasp) return;
  probe.grasp.clear();
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

Scene readScene(YamlDocument document, const std::string& base_directory,
                const std::vector<std::string>& overrides, const std::string& overridden_by) {
  for (const std::string& assignment : overrides) document.override(assignment, overridden_by);
  const YamlMap root(document.root(), sceneKeys());
  Scene scene;
  readCloth(root, base_directory, scene.cloth);
  readOptions(root, worldOptions(scene));
  if (const auto obstacles = root.find("obstacles")) {
    for (const YamlValue& value : obstacles->list()) readObstacle(value, scene.obstacles.emplace_back());
  }
  readProbes(root, scene.cloth, scene.probes);
  readGroup(root, "solver", optionsOf(scene.solver));
  readGroup(root, "adapt", optionsOf(scene.adapt));
  readGroup(root, "stop", optionsOf(scene.stop));
  checkScene(scene, [&](const std::string& key) { return document.locate(key); });
  return scene;
}

}  // namespace

Scene loadScene(const std::string& file, const std::vector<std::string>& overrides,
                const std::string& overridden_by) {
  return readScene(YamlDocument::fromFile(file), std::filesystem::path(file).parent_path().string(),
                   overrides, overridden_by);
}

Scene parseScene(const std::string& yaml, const std::string& origin, const std::string& base_directory,
                 const std::vector<std::string>& overrides) {
  return readScene(YamlDocument::fromText(yaml, origin), base_directory, overrides, "--set");
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
