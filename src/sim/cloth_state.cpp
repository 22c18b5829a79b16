// Part of ClothWorld that saves and loads.
#include <climits>
#include <string>

#include "sim/cloth_world.h"
#include "sim/scene_identity.h"

namespace haptic_cloth {

void ClothWorld::serialize(Archive& archive) {
  serializeIdentity(archive, scene);
  archive.within("steps", steps, 0, LONG_MAX / 2);
  serializeCloth(archive);
  archive("contacts", contacts);
  serializeProbes(archive);
  serializeIdle(archive);
  archive("objective", objective);
  archive("supplied", supplied_);
  archive("let_out", let_out_);
  archive("cost.motion", cost.motion);
  archive("cost.stretch", cost.stretch);
  archive("cost.bend", cost.bend);
  archive("cost.shear", cost.shear);
  archive("support_force", support_force);
}

void ClothWorld::serializeCloth(Archive& archive) {
  archive("leaves", leaves);
  archive("particles", state);
  if (archive.loads()) {
    mesh.rebuild(leaves);
    takeMesh();
  }
  // Hanging nodes may differ from the mean of their masters in the last bits.
  archive("nodes", nodes_);
  archive("velocities", velocities_);
  if (archive.loads()) weight_.assign(mesh.nodes(), 0.0);
  archive("weight", weight_);
  archive("fabric", internal);
  adaptation_.serialize(archive, steps);
  archive("rest", sleep_);
}

void ClothWorld::serializeProbes(Archive& archive) {
  const int particles = grid.particles(), count = static_cast<int>(probes.size());
  archive("probe", probe_steps_);
  archive("probe_memory", memories_);
  archive.each("probe_present", probes, &ProbeReport::present);
  archive.each("probe_device", probes, &ProbeReport::device);
  archive.each("probe_proxy", probes, &ProbeReport::proxy);
  archive.each("probe_velocity", probes, &ProbeReport::velocity);
  archive.each("probe_force", probes, &ProbeReport::force);
  archive.each("probe_torque", probes, &ProbeReport::torque);
  archive.each("probe_contact", probes, &ProbeReport::contact);
  archive.each("probe_grasps", probes, &ProbeReport::grasps);
  for (int k = 0; k < count; ++k) {
    const std::string name = "touched[" + std::to_string(k) + "]";
    archive.length(name + ".count", touched_by_[k], particles);
    archive.within(name, touched_by_[k], 0, particles - 1);
  }
  archive.length("held_count", held_, particles);
  archive.each("held_particles", held_, &HeldParticle::particle);
  archive.each("held_by", held_, &HeldParticle::probe);
  archive.each("held_offsets", held_, &HeldParticle::offset);
  for (const HeldParticle& held : held_) {
    const bool inside =
        held.particle >= 0 && held.particle < particles && held.probe >= 0 && held.probe < count;
    archive.check(inside, "held_particles", "must be particles held by probes of the scene");
  }
}

void ClothWorld::serializeIdle(Archive& archive) {
  archive.within("idle.quiet", quiet_, 0, INT_MAX / 2);
  archive("idle.idle", idle_);
  archive.length("idle.count", idle_probes_, probe_steps_.size());
  archive.each("idle.present", idle_probes_, &ProbeStep::present);
  archive.each("idle.devices", idle_probes_, &ProbeStep::device);
  archive("idle.residual", idle_residual_);
}

void ClothWorld::ProbeMemory::serialize(Archive& archive) {
  archive("entered", entered);
  archive("closed", closed);
  archive("before", before);
  archive("after", after);
  archive("coupling", coupling);
}

}  // namespace haptic_cloth
