/// Which particles have come to rest, and the force each was left with.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// A particle that has been slower than `speed` for kSteps steps sleeps: it stays where it is until the force
/// on it differs from what it fell asleep with.
class Rest {
 public:
  static constexpr int kSteps = 50;

  /// @param speed [m/s]; 0: none ever sleeps
  Rest(const Grid& grid, double speed);

  /// Another speed from now on; all are awake.
  void setSpeed(double speed);

  bool possible() const { return speed_ > 0.0; }

  /// Before a solve: which nodes may sleep, and the forces they are to be compared with, those now where they
  /// have just fallen asleep. @param forces on the nodes when they stand still [N]
  void look(const ActiveMesh& mesh, const Field& forces);
  bool sleeps(int node) const { return sleeps_[node] != 0; }
  Vec3 reference(int node) const { return references_[node]; }

  /// After a step. @param awake whether a node took part in the solve  @param disturbed whether its force
  /// woke it
  template <class Awake, class Disturbed>
  void update(const ActiveMesh& mesh, const Field& velocities, const Awake& awake,
              const Disturbed& disturbed) {
    for (int n = 0; n < mesh.free; ++n) {
      if (!awake(n)) continue;
      Particle& p = particles_[mesh.particle[n]];
      p.known = false;
      p.still = velocities[n].norm() < speed_ && !disturbed(n) ? p.still + 1 : 0;
    }
  }

  void serialize(Archive& archive);

  /// Corners and inside of a cell that changes.
  void disturb(const Grid& grid, const Cell& cell);

 private:
  struct Particle {
    int still = 0;       ///< steps in a row that it was slow
    bool known = false;  ///< `force` is what it fell asleep with
    Vec3 force = Vec3::Zero();
  };
  double speed_;
  std::vector<Particle> particles_;  ///< of the finest grid
  std::vector<char> sleeps_;         ///< a node each
  Field references_;
};

}  // namespace haptic_cloth
