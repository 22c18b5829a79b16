#include "sim/moving_pins.h"

namespace haptic_cloth {
namespace {

/// Position at a time [s] of a point that was at `start`.
Vec3 moved(const Pin& pin, double time, const Vec3& start) {
  const double rate = pin.turn.norm();
  Vec3 arm = start - pin.centre;
  if (rate > 0.0) arm = Eigen::AngleAxisd(rate * time, pin.turn / rate) * arm;
  return pin.centre + time * pin.velocity + arm;
}

}  // namespace

MovingPins::MovingPins(const std::vector<Pin>& pins, const Grid& grid, const std::vector<Vec3>& flat)
    : pins_(pins) {
  std::vector<char> taken(grid.particles(), 0);
  for (std::size_t k = 0; k < pins.size(); ++k) {
    const Pin& pin = pins[k];
    for (int j = pin.j0; j <= pin.j1; ++j) {
      for (int i = pin.i0; i <= pin.i1; ++i) {
        const int p = grid.particle(i, j);
        if (taken[p] == 0 && pin.moves()) particles_.push_back({p, static_cast<int>(k), flat[p]});
        taken[p] = 1;
      }
    }
  }
}

void MovingPins::place(double time, const ActiveMesh& mesh, Field& nodes) const {
  for (const Particle& p : particles_) nodes.set(mesh.node[p.particle], moved(pins_[p.pin], time, p.start));
}

}  // namespace haptic_cloth
