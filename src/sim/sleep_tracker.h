/// Sleeping particles: which have come to rest, and the force on each when it fell asleep.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Decides which particles sleep. A particle that has been slower than `speed` for kSteps steps may
/// sleep: it keeps its position until the force on it differs from that when it fell asleep.
/// Sleeping particles count in the residual of a step like all others, so together they may use up
/// the tolerance only as far as it leaves room for the others.
class SleepTracker {
 public:
  static constexpr int kSteps = 50;

  /// @param speed particles slower than this may sleep [m/s]; 0: none ever sleeps
  SleepTracker(const Grid& grid, double speed);

  /// Changes the speed; all particles wake.
  void setSpeed(double speed);

  bool possible() const { return speed_ > 0.0; }

  /// Starts a step, in which no node has been disturbed yet.
  void begin(const ActiveMesh& mesh) { disturbed_.assign(mesh.nodes(), 0); }

  /// Decides which of the sleeping nodes may stay asleep.
  /// @param forces on the nodes without velocity; compared with those when they fell asleep [N]
  /// @param residuals unbalanced forces if the nodes stop now; differ from `forces` only for moving
  /// nodes [N]
  /// @param tolerance of the solve [m/s²]
  /// @param gravity unit of the tolerance [m/s²]
  /// @param awake flag for each node: it takes part in the solve
  /// @param carried flag for each node: it may not sleep, because what it lies on moves
  void updateCandidates(const ActiveMesh& mesh, const Field& forces, const Field& residuals, double tolerance,
                        double gravity, const std::vector<char>& awake, const std::vector<char>& carried);
  bool sleeps(int node) const { return sleeps_[node] != 0; }

  /// Updates the particles after a step.
  /// @param awake flag for each node: it took part in the solve
  /// @param driven flag for each node: it is being moved, however slowly
  void update(const ActiveMesh& mesh, const Field& velocities, const std::vector<char>& awake,
              const std::vector<char>& driven);

  void serialize(Archive& archive);

  /// Wakes all particles of a cell that changes.
  void disturb(const Grid& grid, const Cell& cell);

 private:
  struct Particle {
    int still = 0;       ///< successive steps in which it was slow; no more than kSteps count
    bool known = false;  ///< `force` is valid: the force when it fell asleep [N]
    Vec3 force = Vec3::Zero();
  };
  /// @param wakes change of force over mass that wakes [m/s²]
  bool isCalm(const ActiveMesh& mesh, int node, const Vec3& force, double wakes);
  void keepBalance(const ActiveMesh& mesh, const Field& residuals, double tolerance);

  double speed_;
  std::vector<Particle> particles_;  ///< one for each particle of the finest grid
  std::vector<char> sleeps_;         ///< one flag for each node
  std::vector<char> disturbed_;      ///< one flag for each node: its force woke it in this step
};

}  // namespace haptic_cloth
