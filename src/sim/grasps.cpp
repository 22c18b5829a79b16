#include "sim/grasps.h"

#include <algorithm>
#include <string>

namespace haptic_cloth {

Grasps::Grasps(int probes, const Grid& grid) : particles_(grid.particles()), touched_by_(probes) {
  held_.reserve(particles_);
  nodes_.reserve(particles_);
  for (auto& list : touched_by_) list.reserve(particles_);
  touched_.reserve(4 * particles_);
}

void Grasps::release(int k) {
  const auto own = [k](const HeldParticle& held) { return held.probe == k; };
  held_.erase(std::remove_if(held_.begin(), held_.end(), own), held_.end());
  touched_by_[k].clear();
}

void Grasps::update(const Probes& probes, const ActiveMesh& mesh, const ParticleState& state) {
  const auto is_free = [&mesh](int particle) {
    return mesh.node[particle] >= 0 && mesh.node[particle] < mesh.free;
  };
  for (int k = 0; k < probes.count(); ++k) {
    const auto own = [k](const HeldParticle& held) { return held.probe == k; };
    if (!probes.isClosed(k) || std::any_of(held_.begin(), held_.end(), own)) continue;
    const Quat& turned = probes.orientation(k);
    for (const int particle : touched_by_[k]) {
      const auto same = [particle](const HeldParticle& held) { return held.particle == particle; };
      if (!is_free(particle) || std::any_of(held_.begin(), held_.end(), same)) continue;
      const Vec3 arm = turned.conjugate() * (state.position[particle] - probes.steps()[k].proxy);
      held_.push_back({particle, k, arm});
    }
  }
  nodes_.clear();
  for (const HeldParticle& held : held_) {
    if (!is_free(held.particle)) continue;
    const Vec3 offset = probes.orientation(held.probe) * held.arm;
    nodes_.push_back({mesh.node[held.particle], held.probe, offset, offset});
  }
}

bool Grasps::holds(int k) const {
  return std::any_of(nodes_.begin(), nodes_.end(), [k](const HeldNode& held) { return held.probe == k; });
}

void Grasps::noteTouched(const Probes& probes, const ContactSet& contacts, const ActiveMesh& mesh) {
  for (int k = 0; k < probes.count(); ++k) {
    if (!probes.isPresent(k) || !probes.isClosed(k)) continue;
    touched_.clear();
    contacts.touchedNodes(k, touched_);
    for (int& n : touched_) n = mesh.particle[n];
    std::sort(touched_.begin(), touched_.end());
    touched_by_[k].assign(touched_.begin(), std::unique(touched_.begin(), touched_.end()));
  }
}

void Grasps::serialize(Archive& archive) {
  const int probes = static_cast<int>(touched_by_.size());
  for (int k = 0; k < probes; ++k) {
    const std::string name = "touched[" + std::to_string(k) + "]";
    archive.length(name + ".count", touched_by_[k], particles_);
    archive.within(name, touched_by_[k], 0, particles_ - 1);
  }
  archive.length("held_count", held_, particles_);
  archive.each("held_particles", held_, &HeldParticle::particle);
  archive.each("held_by", held_, &HeldParticle::probe);
  archive.each("held_arms", held_, &HeldParticle::arm);
  for (const HeldParticle& held : held_) {
    const bool inside =
        held.particle >= 0 && held.particle < particles_ && held.probe >= 0 && held.probe < probes;
    archive.check(inside, "held_particles", "must be particles held by probes of the scene");
  }
}

}  // namespace haptic_cloth
