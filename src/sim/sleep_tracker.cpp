#include "sim/sleep_tracker.h"

#include <algorithm>

namespace haptic_cloth {

SleepTracker::SleepTracker(const Grid& grid, double speed) : speed_(speed), particles_(grid.particles()) {
  sleeps_.reserve(grid.particles());
  disturbed_.reserve(grid.particles());
}

void SleepTracker::setSpeed(double speed) {
  speed_ = speed;
  std::fill(particles_.begin(), particles_.end(), Particle());
}

void SleepTracker::updateCandidates(const ActiveMesh& mesh, const Field& forces, const Field& residuals,
                                    double tolerance, double gravity, const std::vector<char>& awake,
                                    const std::vector<char>& carried) {
  // Change of force that wakes: more than a solve may leave, but less than the weight, so that cloth whose
  // support goes away wakes at any tolerance.
  constexpr double kDisturbed = 3.0, kWeightShare = 0.5;
  const double wakes = std::min(kDisturbed * tolerance, kWeightShare * gravity);
  sleeps_.assign(mesh.nodes(), 0);
  for (int n = 0; n < mesh.free; ++n) {
    if (awake[n] == 0) sleeps_[n] = carried[n] == 0 && isCalm(mesh, n, forces[n], wakes);
  }
  keepBalance(mesh, residuals, tolerance);
}

void SleepTracker::update(const ActiveMesh& mesh, const Field& velocities, const std::vector<char>& awake,
                          const std::vector<char>& driven) {
  for (int n = 0; n < mesh.free; ++n) {
    if (awake[n] == 0) continue;
    Particle& p = particles_[mesh.particle[n]];
    const bool still = velocities[n].norm() < speed_ && disturbed_[n] == 0 && driven[n] == 0;
    p.known = false;
    p.still = still ? std::min(p.still, kSteps - 1) + 1 : 0;
  }
}

/// Tells whether a node was slow for long enough and the force on it is that when it fell asleep.
bool SleepTracker::isCalm(const ActiveMesh& mesh, int node, const Vec3& force, double wakes) {
  Particle& p = particles_[mesh.particle[node]];
  if (p.still < kSteps) return false;
  if (!p.known) p.force = force;
  p.known = true;
  const double allowed = wakes * mesh.mass[node];
  disturbed_[node] = !((force - p.force).squaredNorm() <= allowed * allowed);
  return disturbed_[node] == 0;
}

/// Limits the unbalanced force on all sleeping nodes: to the tolerance if all nodes sleep,
/// otherwise to a little less, so that the awake nodes can compensate. Beyond that limit, each node
/// with more than half the tolerance of its own wakes; the others then leave less than half of it.
void SleepTracker::keepBalance(const ActiveMesh& mesh, const Field& residuals, double tolerance) {
  constexpr double kShare = 0.9, kOwn = 0.5;
  double square = 0.0, mass = 0.0;
  bool all = true;
  for (int n = 0; n < mesh.free; ++n) {
    mass += mesh.mass[n];
    if (sleeps_[n] != 0) square += residuals[n].squaredNorm() / mesh.mass[n];
    all = all && sleeps_[n] != 0;
  }
  const double allowed = (all ? 1.0 : kShare) * tolerance;
  if (square <= allowed * allowed * mass) return;
  for (int n = 0; n < mesh.free; ++n) {
    const double own = kOwn * tolerance * mesh.mass[n];
    if (!(residuals[n].squaredNorm() <= own * own)) sleeps_[n] = 0;
  }
}

void SleepTracker::serialize(Archive& archive) {
  archive.each("still", particles_, &Particle::still);
  for (const Particle& p : particles_) archive.check(p.still >= 0, "still", "must be >= 0");
  archive.each("known", particles_, &Particle::known);
  archive.each("force", particles_, &Particle::force);
}

void SleepTracker::disturb(const Grid& grid, const Cell& cell) {
  for (int j = cell.j; j <= cell.j + cell.span(); ++j) {
    for (int i = cell.i; i <= cell.i + cell.span(); ++i) particles_[grid.particle(i, j)] = Particle();
  }
}

}  // namespace haptic_cloth
