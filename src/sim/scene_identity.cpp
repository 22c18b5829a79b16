#include "sim/scene_identity.h"

#include "sim/scene_names.h"

namespace haptic_cloth {
namespace {

void same(Archive& archive, const std::string& name, const Vec3& value) {
  archive.same(name, value.data(), 3);
}

void same(Archive& archive, const std::string& name, const Pose& pose) {
  same(archive, name + "position", pose.position);
  archive.same(name + "orientation", pose.orientation.coeffs().data(), 4);
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
}

void serializeCloth(Archive& archive, const ClothOptions& cloth) {
  for (const int k : {0, 1}) archive.same("cloth.particles[" + std::to_string(k) + "]", cloth.particles[k]);
  archive.same("cloth.size", cloth.size.data(), cloth.size.size());
  same(archive, "cloth.", cloth.pose);
  archive.same("cloth.pins (how many)", static_cast<int>(cloth.pins.size()));
  for (std::size_t k = 0; k < cloth.pins.size(); ++k) {
    const ParticleRange& pin = cloth.pins[k];
    const std::array<double, 4> ends{double(pin.i0), double(pin.i1), double(pin.j0), double(pin.j1)};
    archive.same("cloth.pins[" + std::to_string(k) + "]", ends.data(), ends.size());
  }
  serializeFabric(archive, cloth.fabric);
}

void serializeObstacle(Archive& archive, const std::string& prefix, const Obstacle& obstacle) {
  archive.same(prefix + "name", obstacle.name);
  archive.same(prefix + "shape", nameOf(shapeNames(), obstacle.shape));
  same(archive, prefix + "size", obstacle.size);
  archive.same(prefix + "radius", obstacle.radius);
  archive.same(prefix + "length", obstacle.length);
  same(archive, prefix, obstacle.pose);
  archive.same(prefix + "friction", obstacle.friction);
}

void serializeProbe(Archive& archive, const std::string& prefix, const ProbeOptions& probe) {
  archive.same(prefix + "radius", probe.radius);
  archive.same(prefix + "length", probe.length);
  archive.same(prefix + "friction", probe.friction);
  archive.same(prefix + "coupling_stiffness", probe.coupling_stiffness);
  archive.same(prefix + "coupling_damping", probe.coupling_damping);
}

void serializeWorld(Archive& archive, const Scene& scene) {
  same(archive, "gravity", scene.gravity);
  archive.same("air_damping", scene.air_damping);
  archive.same("obstacles (how many)", static_cast<int>(scene.obstacles.size()));
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
    serializeObstacle(archive, "obstacles[" + std::to_string(k) + "].", scene.obstacles[k]);
  }
  archive.same("probes (how many)", static_cast<int>(scene.probes.size()));
  for (std::size_t k = 0; k < scene.probes.size(); ++k) {
    archive.same("probes[" + std::to_string(k) + "]", scene.probes[k].name);
    serializeProbe(archive, "probes." + scene.probes[k].name + ".", scene.probes[k]);
  }
}

void serializeSolver(Archive& archive, const SolverOptions& solver) {
  archive.same("solver.time_step", solver.time_step);
  archive.same("solver.integrator", nameOf(integratorNames(), solver.integrator));
  archive.same("solver.cost", nameOf(costNames(), solver.cost));
  archive.same("solver.preconditioner", nameOf(preconditionerNames(), solver.minimizer.preconditioner));
  archive.same("solver.tolerance", solver.minimizer.tolerance);
  archive.same("solver.max_iterations", solver.minimizer.max_iterations);
  archive.same("solver.sleep_speed", solver.sleep_speed);
}

void serializeAdapt(Archive& archive, const AdaptOptions& adapt) {
  archive.same("adapt.strategy", nameOf(strategyNames(), adapt.strategy));
  archive.same("adapt.start", nameOf(startNames(), adapt.start));  // work is counted from this mesh
  archive.same("adapt.levels", adapt.levels);
  archive.same("adapt.interval", adapt.interval);
  archive.same("adapt.refine_above", adapt.refine_above);
  archive.same("adapt.coarsen_below", adapt.coarsen_below);
  archive.same("adapt.refine_above_strain", adapt.refine_above_strain);
  archive.same("adapt.coarsen_below_strain", adapt.coarsen_below_strain);
  archive.same("adapt.minimum_age", adapt.minimum_age);
}

}  // namespace

void serializeIdentity(Archive& archive, const Scene& scene) {
  serializeCloth(archive, scene.cloth);
  serializeWorld(archive, scene);
  serializeSolver(archive, scene.solver);
  serializeAdapt(archive, scene.adapt);
}

}  // namespace haptic_cloth
