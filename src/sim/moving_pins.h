/// Pinned particles that move.
#pragma once

#include <vector>

#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Prescribed motion of the pins of a scene; those that do not move are left out.
class MovingPins {
 public:
  /// @param flat positions of all particles at time 0 [m]
  MovingPins(const std::vector<Pin>& pins, const Grid& grid, const std::vector<Vec3>& flat);

  bool any() const { return !particles_.empty(); }

  /// Sets the nodes of the particles to where they are at a time [s].
  void place(double time, const ActiveMesh& mesh, Field& nodes) const;

 private:
  struct Particle {
    int particle;
    int pin;
    Vec3 start;  ///< position at time 0 [m]
  };
  std::vector<Pin> pins_;
  std::vector<Particle> particles_;
};

}  // namespace haptic_cloth
