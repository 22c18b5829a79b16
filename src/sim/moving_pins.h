/// Pinned particles that move.
#pragma once

#include <vector>

#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Prescribed motion of the pins of a scene, each with a clock of its own. The clock of a pin that
/// something stops stands still, and then runs twice as fast until the pin has caught up.
class MovingPins {
 public:
  /// @param flat positions of all particles at time 0 [m]
  MovingPins(const std::vector<Pin>& pins, const Grid& grid, const std::vector<Vec3>& flat);

  bool any() const { return !particles_.empty(); }
  int count() const { return static_cast<int>(pins_.size()); }

  /// Starts a step. @param length [s]  @param end time at its end [s]
  void begin(double length, double end);

  /// Sets the nodes of a pin to where it is to be at the end of the step; none if it does not move.
  void place(int pin, const ActiveMesh& mesh, Field& nodes) const;

  /// Ends a step. @param made share of its way that each pin made [-]
  void advance(const std::vector<double>& made);

  /// Saves or loads the clocks.
  void serialize(Archive& archive);

 private:
  struct Particle {
    int particle;
    int pin;
    Vec3 start;  ///< position at time 0 [m]
  };
  std::vector<Pin> pins_;
  std::vector<Particle> particles_;
  std::vector<double> clocks_, aims_;  ///< of the pins, now and at the end of the step [s]
};

}  // namespace haptic_cloth
