/// Estimate of the error of a probe's force.
#pragma once

#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "sim/cloth.h"
#include "sim/cloth_objective.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Estimates how far the force F on a probe is from that of a converged solve on the finest mesh
/// with short steps, by what a step leaves behind:
///
///     δF² = |U|² + 2 k e + (d |F - F_before|)² + (r |F|)²
///
///     U  net unbalanced force on the nodes near the probe: what the solve did not finish [N]
///     e  energy that coarse cells cannot represent [J]; a spring of stiffness k, that of the
///        coupling, with this energy pulls with √(2 k e)
///     d  delay of the force in backward Euler [time steps]
///     r  errors that none of these shows, such as another start of slip [-]
///
/// Figures: docs/decisions/0029-error-of-the-force.md.
class ForceError {
 public:
  explicit ForceError(const Scene& scene) : scene_(scene) {}

  /// Measures e, which changes slowly: once for each decision about the mesh is enough.
  void noteMesh(const Cloth& cloth) { energy_ = coarseEnergy(cloth); }

  /// Error of the force on a probe [N].
  /// @param unbalanced unbalancedForce() [N]
  /// @param before, force forces at the ends of the last step and of this one [N]
  double estimate(int probe, const Vec3& unbalanced, const Vec3& before, const Vec3& force) const;

  /// Net unbalanced force on the free nodes within 5 radii of a proxy, at the end of a solve [N].
  Vec3 unbalancedForce(int probe, const ClothObjective& solved, const ActiveMesh& mesh) const;

  void serialize(Archive& archive);

  /// Energy that cells coarser than the finest cannot represent [J]: shares of their stretch energy
  /// by (l/l₀)² - 1, and of their bending energy by θ² - θ₀². l is the length of an element and θ
  /// its turning angle; l₀ and θ₀ are those of the finest grid.
  static double coarseEnergy(const Cloth& cloth);

 private:
  const Scene& scene_;
  double energy_ = 0.0;  ///< e [J]
};

}  // namespace haptic_cloth
