#include "sim/moving_pins.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

// Speed of a pin that catches up, over its prescribed speed. It is the least that closes a gap as fast as
// it opened, and gives the cloth at most twice the speed that the scene asks for.
constexpr double kCatchUp = 2.0;

/// Position at a time [s] of a point that was at `start`.
Vec3 moved(const Pin& pin, double time, const Vec3& start) {
  const double rate = pin.turn.norm();
  Vec3 arm = start - pin.centre;
  if (rate > 0.0) arm = Eigen::AngleAxisd(rate * time, pin.turn / rate) * arm;
  return pin.centre + time * pin.velocity + arm;
}

}  // namespace

MovingPins::MovingPins(const std::vector<Pin>& pins, const Grid& grid, const std::vector<Vec3>& flat)
    : pins_(pins), clocks_(pins.size(), 0.0), aims_(pins.size(), 0.0) {
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

void MovingPins::begin(double length, double end) {
  for (int k = 0; k < count(); ++k) aims_[k] = std::min(end, clocks_[k] + kCatchUp * length);
}

void MovingPins::place(int pin, const ActiveMesh& mesh, Field& nodes) const {
  for (const Particle& p : particles_) {
    if (p.pin == pin) nodes.set(mesh.node[p.particle], moved(pins_[pin], aims_[pin], p.start));
  }
}

void MovingPins::advance(const std::vector<double>& made) {
  for (int k = 0; k < count(); ++k)
    clocks_[k] = made[k] < 1.0 ? clocks_[k] + made[k] * (aims_[k] - clocks_[k]) : aims_[k];
}

void MovingPins::serialize(Archive& archive) {
  archive("clocks", clocks_);
  const bool began = std::all_of(clocks_.begin(), clocks_.end(), [](double clock) { return clock >= 0.0; });
  archive.check(began, "clocks", "must be >= 0");
}

}  // namespace haptic_cloth
