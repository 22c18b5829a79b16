/// The cost of [M04], E = E^n + E^s + E^b + E^h, over positions, tensions, moments and shear forces.
#pragma once

#include <vector>

#include "energy/joint_energy.h"
#include "haptic_cloth/report.h"
#include "sim/cloth_objective.h"

namespace haptic_cloth {

/// E^n = Σ h²/(2m) |residual of Newton's law|² [J] with the unknown forces in place of the laws', and the
/// costs of JointEnergy. Contact, friction, air, probe and what else there is act as in ClothObjective, whose
/// step this is. Nodes that a probe holds move with its proxy, which feels their forces and has their
/// inertia. Where E = 0 the condensed cost's gradient vanishes too, and the other way round.
class JointObjective : public Objective {
 public:
  /// @param step the step to be solved: begin() it first
  JointObjective(ClothObjective& step, const ActiveMesh& mesh, const InternalEnergy& internal,
                 ContactSet& contacts, Team& team);

  /// Largest size() can get.
  int capacity() const { return step_.capacity() + elements_.capacity(); }

  /// Unknowns from positions and proxy packed as ClothObjective's; forces as the laws have them where the
  /// step starts.
  void begin(const Vector& start, const Vector& positions, Vector& unknowns);

  int size() const override { return step_.size() + elements_.size(); }
  double evaluate(const Vector& x, Vector& gradient) override;
  Along along(const Vector& d) override;
  void fitPreconditioner() override;
  void precondition(const Vector& gradient, Vector& z) override;

  /// The condensed residual of a state with the same cost: tolerances mean the same for both.
  double residual(const Vector& gradient) const override;

  const CostReport& costs() const { return costs_; }  ///< at the last evaluated point

 private:
  template <class Visit>
  void forPresent(const Visit& visit) const;
  void evaluateElements(const double* forces);
  double residualForces();
  void takeHeld(Field& forces);
  void gatherGradient(Vector& gradient);
  double changeOfForces(const double* d_forces);

  ClothObjective& step_;
  const ActiveMesh& mesh_;
  ContactSet& contacts_;
  Team& team_;
  JointEnergy elements_;
  CostReport costs_;
  Field nodes_, motion_, residual_, gradient_, diagonal_, stiffness_;
  std::vector<double> weight_;        ///< h²/m of the nodes, zero for those without a law of motion [m/N]
  std::vector<double> proxy_weight_;  ///< of the probes, 1/(stiffness of coupling and held mass) [m/N]
  Proxies proxies_, proxy_motions_, proxy_residuals_;
  Proxies hold_;  ///< what acts on the nodes a probe holds, or its change, acts on its proxy [N]
  Vector inverse_diagonal_;
};

}  // namespace haptic_cloth
