#include "scene/scene_identity.h"

#include "scene/scene_options.h"
#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

/// Saves or compares the value of one option.
struct Comparer {
  Archive& archive;
  const std::string& name;

  void operator()(const Numbers<double>& numbers) const { archive.same(name, numbers.first, numbers.count); }
  void operator()(const Numbers<int>& numbers) const {
    for (std::size_t k = 0; k < numbers.count; ++k) {
      archive.same(numbers.count > 1 ? indexed(name, k) : name, numbers.first[k]);
    }
  }
  void operator()(const Quat* value) const { archive.same(name, value->coeffs().data(), 4); }
  void operator()(const bool* value) const { archive.same(name, *value ? 1 : 0); }
  void operator()(const std::string* value) const { archive.same(name, *value); }
  void operator()(const Choice& choice) const { archive.same(name, choice.names[choice.get()]); }
  void operator()(const OwnReader&) const {}
};

void same(Archive& archive, const std::string& prefix, const Options& options) {
  for (const Option& option : options) {
    if (option.in_state) std::visit(Comparer{archive, prefix + option.key}, option.field);
  }
}

void similar(Archive& archive, const std::string& name, const Curve& curve) {
  std::vector<double> points;
  for (const Curve::Interval& interval : curve.intervals()) {
    points.insert(points.end(), {interval.force, interval.slope / curve.inverseStep()});
  }
  archive.similar(name + ".range", {curve.begin(), 1.0 / curve.inverseStep()});
  archive.similar(name, points);
}

void similar(Archive& archive, const std::string& name, const Loop& law) {
  similar(archive, name + ".loading", law.upper());
  similar(archive, name + ".unloading", law.lower());
  if (law.hasMemory()) similar(archive, name + ".reversal", law.path());
}

void serializeFabric(Archive& archive, const Fabric& fabric) {
  archive.same("cloth.fabric", fabric.name);
  const std::string prefix = "cloth.fabric.";
  archive.same(prefix + "areal_density", fabric.areal_density);
  archive.same(prefix + "thickness", fabric.thickness);
  archive.same(prefix + "twist_rigidity", fabric.twist_rigidity);
  for (const auto& [direction, name] : {std::pair(kWarp, "warp"), {kWeft, "weft"}}) {
    similar(archive, prefix + "tensile." + name, fabric.tensile[direction]);
    similar(archive, prefix + "bending." + name, fabric.bending[direction]);
  }
  similar(archive, prefix + "shear", fabric.shear);
  const Compression compression = fabric.compression.value_or(Compression());
  archive.same(prefix + "compression.T0", compression.thickness);
  archive.same(prefix + "compression.Tm", compression.pressed_thickness);
  archive.same(prefix + "compression.LC", compression.linearity);
}

void serializeCloth(Archive& archive, ClothOptions& cloth) {
  same(archive, "cloth.", optionsOf(cloth));
  archive.same("cloth.pins (how many)", static_cast<int>(cloth.pins.size()));
  for (std::size_t k = 0; k < cloth.pins.size(); ++k) {
    Pin& pin = cloth.pins[k];
    const std::array<double, 4> ends{double(pin.i0), double(pin.i1), double(pin.j0), double(pin.j1)};
    archive.same(indexed("cloth.pins", k), ends.data(), ends.size());
    same(archive, indexed("cloth.pins", k) + ".", optionsOf(pin));
  }
  serializeFabric(archive, cloth.fabric);
}

void serializeWorld(Archive& archive, Scene& scene) {
  same(archive, "", worldOptions(scene));
  archive.same("obstacles (how many)", static_cast<int>(scene.obstacles.size()));
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
    Obstacle& obstacle = scene.obstacles[k];
    const std::string prefix = indexed("obstacles", k) + ".";
    archive.same(prefix + "name", obstacle.name);
    archive.same(prefix + "shape", nameOf(shapeNames(), obstacle.shape));
    same(archive, prefix, optionsOf(obstacle));
  }
  archive.same("probes (how many)", static_cast<int>(scene.probes.size()));
  for (std::size_t k = 0; k < scene.probes.size(); ++k) {
    archive.same(indexed("probes", k), scene.probes[k].name);
    same(archive, "probes." + scene.probes[k].name + ".", optionsOf(scene.probes[k]));
  }
}

}  // namespace

void serializeIdentity(Archive& archive, const Scene& saved) {
  Scene scene = saved;  // rows point to members that could be written
  serializeCloth(archive, scene.cloth);
  serializeWorld(archive, scene);
  same(archive, "solver.", optionsOf(scene.solver));
  same(archive, "adapt.", optionsOf(scene.adapt));
}

}  // namespace haptic_cloth
