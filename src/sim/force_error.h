/// Estimate of the error of a probe's force.
#pragma once

#include <vector>

#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "sim/cloth.h"
#include "sim/cloth_objective.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Estimates how far the force F on a probe is from that of a converged solve on the finest mesh
/// with short steps, by what a step leaves behind:
///
///     δF² = max(U, U_past / 2)² + min(√(2 k e_s), s |F|)² + 2 k e_b + (d |F - F_before|)² + (r |F|)²
///
///     U         net unbalanced force on the nodes near the probe, or on it [N]: what the solve did not
///               finish
///     U_past    largest U of the steps before; it fades with the distance that the probe moves,
///               because cloth that was left in a wrong place stays there while the hand rests [N]
///     e_s, e_b  energies of stretch and bending that coarse cells cannot represent [J]; a spring
///               of stiffness k, that of the coupling, with the energy e pulls with √(2 k e)
///     s         relative error of the elastic energy: that of a force that stretches cloth. Cloth
///               is often softer than the coupling. [-]
///     d         delay of the force in backward Euler [time steps]
///     r         errors that none of these shows, such as another start of slip [-]
///
/// Figures: docs/decisions/0029-error-of-the-force.md.
class ForceError {
 public:
  explicit ForceError(const Scene& scene) : scene_(scene), past_(scene.probes.size(), 0.0) {}

  /// Measures the coarse cells if a probe feels the cloth: when it begins to, and at decisions about
  /// the mesh. In between they change slowly.
  void noteCloth(const Cloth& cloth, bool felt, bool decision);

  /// Error of the force on a probe at the end of a step [N]; to be called once for each.
  /// @param moved distance of the proxy in this step [m]
  /// @param unbalanced unbalancedForce() [N]
  /// @param before, force forces at the ends of the last step and of this one [N]
  double estimate(int probe, double moved, double unbalanced, const Vec3& before, const Vec3& force);

  /// Net unbalanced force on the free nodes within 3 extents of a proxy, or that on the proxy if it is
  /// larger, at the end of a solve [N].
  double unbalancedForce(int probe, const ClothObjective& solved, const ActiveMesh& mesh) const;

  /// Forgets what the steps of a probe left behind: one that returns is a new one.
  void forget(int probe) { past_[probe] = 0.0; }

  void serialize(Archive& archive);

  /// Energies of the cloth [J]. l is the length of an element and θ its turning angle; l₀ and θ₀ are
  /// those of the finest grid.
  struct CoarseEnergy {
    double stretch = 0.0;  ///< stretch energy of each edge times (l/l₀)² - 1
    double bend = 0.0;     ///< bending energy of each triple times θ² - θ₀²
    double whole = 0.0;    ///< stretch and bending energy

    void serialize(Archive& archive);
  };

  static CoarseEnergy coarseEnergy(const Cloth& cloth);

 private:
  const Scene& scene_;
  CoarseEnergy coarse_;
  bool felt_ = false;         ///< in the last step
  std::vector<double> past_;  ///< U_past of each probe [N]
};

}  // namespace haptic_cloth
