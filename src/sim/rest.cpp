#include "sim/rest.h"

#include <algorithm>

namespace haptic_cloth {

Rest::Rest(const Grid& grid, double speed) : speed_(speed), particles_(grid.particles()) {
  sleeps_.reserve(grid.particles());
  references_.reserve(grid.particles());
}

void Rest::setSpeed(double speed) {
  speed_ = speed;
  std::fill(particles_.begin(), particles_.end(), Particle());
}

void Rest::look(const ActiveMesh& mesh, const Field& forces) {
  sleeps_.assign(mesh.nodes(), 0);
  references_.clear(mesh.nodes());
  for (int n = 0; n < mesh.free; ++n) {
    Particle& p = particles_[mesh.particle[n]];
    if (p.still < kSteps) continue;
    if (!p.known) p.force = forces[n];
    p.known = true;
    sleeps_[n] = 1;
    references_.set(n, p.force);
  }
}

void Rest::serialize(Archive& archive) {
  archive.each("still", particles_, &Particle::still);
  for (const Particle& p : particles_) archive.check(p.still >= 0, "still", "must be >= 0");
  archive.each("known", particles_, &Particle::known);
  archive.each("force", particles_, &Particle::force);
}

void Rest::disturb(const Grid& grid, const Cell& cell) {
  for (int j = cell.j; j <= cell.j + cell.span(); ++j) {
    for (int i = cell.i; i <= cell.i + cell.span(); ++i) particles_[grid.particle(i, j)] = Particle();
  }
}

}  // namespace haptic_cloth
