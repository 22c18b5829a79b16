/// Which particles have come to rest, and the force each was left with.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// A particle that has been slower than `speed` for kSteps steps sleeps, as far as the forces on
/// sleepers are balanced: it stays where it is until the force on it differs from what it fell
/// asleep with. Sleepers count in a step's residual like all others, so they never take up more of
/// the tolerance than leaves room for those awake.
class Rest {
 public:
  static constexpr int kSteps = 50;

  /// @param speed [m/s]; 0: none ever sleeps
  Rest(const Grid& grid, double speed);

  /// Another speed from now on; all are awake.
  void setSpeed(double speed);

  bool possible() const { return speed_ > 0.0; }

  /// Before a step: none has been disturbed in it.
  void begin(const ActiveMesh& mesh) { disturbed_.assign(mesh.nodes(), 0); }

  /// Which of the nodes that are not awake may stay so.
  /// @param forces on the nodes when they stand still; compared with those they fell asleep with [N]
  /// @param residuals what is unbalanced if they stop now; differs from `forces` only where they move [N]
  /// @param tolerance of the solve [m/s²]  @param awake whether a node takes part in it
  template <class Awake>
  void look(const ActiveMesh& mesh, const Field& forces, const Field& residuals, double tolerance,
            const Awake& awake) {
    sleeps_.assign(mesh.nodes(), 0);
    for (int n = 0; n < mesh.free; ++n) {
      if (!awake(n)) sleeps_[n] = isCalm(mesh, n, forces[n], tolerance);
    }
    keepBalance(mesh, residuals, tolerance);
  }
  bool sleeps(int node) const { return sleeps_[node] != 0; }

  /// After a step. @param awake whether a node took part in the solve  @param driven whether it is being
  /// moved where it may not stay, however slowly
  template <class Awake, class Driven>
  void update(const ActiveMesh& mesh, const Field& velocities, const Awake& awake, const Driven& driven) {
    for (int n = 0; n < mesh.free; ++n) {
      if (!awake(n)) continue;
      Particle& p = particles_[mesh.particle[n]];
      const bool still = velocities[n].norm() < speed_ && disturbed_[n] == 0 && !driven(n);
      p.known = false;
      p.still = still ? p.still + 1 : 0;
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
  bool isCalm(const ActiveMesh& mesh, int node, const Vec3& force, double tolerance);
  void keepBalance(const ActiveMesh& mesh, const Field& residuals, double tolerance);

  double speed_;
  std::vector<Particle> particles_;  ///< of the finest grid
  std::vector<char> sleeps_;         ///< a node each
  std::vector<char> disturbed_;      ///< a node each: its force woke it in the step in hand
};

}  // namespace haptic_cloth
