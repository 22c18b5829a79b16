/// Cost of [M04], E = E^n + E^s + E^b + E^h, over positions, tensions, moments and shear forces.
#pragma once

#include <vector>

#include "energy/joint_energy.h"
#include "haptic_cloth/report.h"
#include "sim/cloth_objective.h"

namespace haptic_cloth {

/// E^n = Σ h²/(2m) |residual of Newton's law|² [J], with the unknown forces instead of those of the
/// laws, plus the costs of JointEnergy. Contact, friction, air and probe act as in ClothObjective,
/// which provides the step. Held nodes move with the proxy of their probe, which carries their
/// forces and inertia; proxies do not turn. The gradient of the condensed cost vanishes where E
/// = 0, and vice versa.
class JointObjective : public Objective {
 public:
  /// @param step the step to be solved, after its begin()
  JointObjective(ClothObjective& step, const ActiveMesh& mesh, const InternalEnergy& internal,
                 ContactSet& contacts, Team& team);

  /// Upper bound of size().
  int capacity() const { return step_.capacity() + elements_.capacity(); }

  /// Fills the unknowns: positions and proxies packed as in ClothObjective, forces by the laws at
  /// the start of the step.
  void begin(const Vector& start, const Vector& positions, Vector& unknowns);

  int size() const override { return step_.size() + elements_.size(); }
  double evaluate(const Vector& x, Vector& gradient) override;
  Along along(const Vector& d, double slope) override;
  void fitPreconditioner(bool thoroughly) override;
  void precondition(const Vector& gradient, Vector& z) override;

  /// Residual of the condensed cost with the same value: a tolerance means the same for both costs.
  double residual(const Vector& gradient) const override;

  const CostReport& costs() const { return costs_; }  ///< values at the last evaluated point

 private:
  template <class Visit>
  void forPresent(const Visit& visit) const;
  void evaluateElements(const double* forces);
  double residualForces();
  void takeHeld(Field& forces);
  void gatherAlong(const Field& field);
  void gatherGradient(Vector& gradient);
  double changeOfForces(const double* d_forces);

  ClothObjective& step_;
  const ActiveMesh& mesh_;
  ContactSet& contacts_;
  Team& team_;
  JointEnergy elements_;
  CostReport costs_;
  Field nodes_, motion_, residual_, gradient_, diagonal_, stiffness_;
  std::vector<double> weight_;  ///< h²/m of the nodes, zero for those without a law of motion [m/N]
  /// 1/(stiffness of the coupling + inertia of the held mass) for each probe [m/N].
  std::vector<double> proxy_weight_;
  Proxies proxies_, proxy_motions_, proxy_residuals_;
  std::vector<Vec3> hold_;  ///< forces on held nodes, or their change, handed to the proxy [N]
  Vector inverse_diagonal_;
};

}  // namespace haptic_cloth
