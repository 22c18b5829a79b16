/// Balance of energy over the steps, and the guard that keeps it.
#pragma once

#include "contact/contact_set.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"
#include "sim/cloth.h"
#include "sim/cloth_objective.h"
#include "sim/probes.h"
#include "sim/step_solver.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Energy of the cloth, the work that its inputs supply, and the energy that changes of the method
/// create: of the mesh, and of the contact samples, which each step chooses again. Energy missing
/// in the balance at the end of a step counts as dissipated, also after a failed step.
class EnergyBalance {
 public:
  /// @param solved objective with the energies of the cloth at the start
  EnergyBalance(const Cloth& cloth, const ClothObjective& solved);

  /// Starts a step. @param last objective with the solution of the step before
  void beginStep(const ClothObjective& last);

  /// Records the energy that the mesh change of the step created [J].
  void noteMeshChange(double created) { created_by_mesh_ = created; }

  /// Records the values where the solve of the step started.
  /// @param solids_move an obstacle moves in the step, or a probe turns as prescribed
  void noteStart(const StepSolver::Start& start, bool solids_move);

  /// Records the work of moving pins in the step: on the cloth, and on the air around them [J].
  void notePinWork(double work, double drag) {
    pin_work_ = work;
    pin_drag_ = drag;
  }

  /// Limits the kinetic energy to the energy at the start of the step plus the work of its inputs
  /// minus what is now stored or dissipated. Energy that a mesh change created beyond the kinetic
  /// energy is not carried over to later steps: that debt would freeze cloth that is about to
  /// buckle.
  /// @param kinetic_before at the start of the step [J]
  /// @param gravity_work in the step [J]
  /// @param converged whether the step was solved to its tolerance
  /// @return factor applied to the velocities within the cloth, 1 if none was needed
  double guard(double kinetic_before, double gravity_work, const ClothObjective& solved, bool converged,
               Cloth& cloth);

  /// Adds the work of devices, obstacles and pins. Devices work on spring and damper of their couplings;
  /// removing a device removes the energy of its spring. Obstacles work by moving and by ejecting
  /// cloth.
  void update(const Scene& scene, const ClothObjective& solved, const ContactSet& contacts, Probes& probes);

  EnergyReport report(const Cloth& cloth, const ClothObjective& solved) const;

  /// Energy that the mesh change and the contact samples of the last step created, or that elastic slip
  /// gave back: it had counted as lost [J].
  double created() const { return created_by_mesh_ + created_by_samples_ + returned_by_slip_; }

  void serialize(Archive& archive);

 private:
  double balanceUndone(double work, double excess);

  double initial_ = 0.0;             ///< energy at the start [J]
  double supplied_ = 0.0;            ///< initial_ plus work of devices, obstacles and pins [J]
  double undone_ = 0.0;              ///< work that converged solves left undone, not yet made good [J]
  double pin_work_ = 0.0;            ///< in the current step [J]
  double pin_drag_ = 0.0;            ///< in the current step [J]
  double created_by_mesh_ = 0.0;     ///< in the current step [J]
  double created_by_samples_ = 0.0;  ///< in the current step [J]
  double contact_before_ = 0.0;      ///< contact energy at the end of the last step [J]
  double layers_before_ = 0.0;       ///< part of it: of layers of the cloth [J]
  double friction_before_ = 0.0;     ///< potential of friction at the end of the last step [J]
  double returned_by_slip_ = 0.0;    ///< in the current step [J]
  double friction_start_ = 0.0;      ///< potential of friction at x⁰, if no solid moves in the step [J]
  double ejection_work_ = 0.0;       ///< ContactSet::ejectionWork() of the last step [J]
  double energy_before_ = 0.0;       ///< energies in Φ(x⁰), minus created() if positive [J]
};

}  // namespace haptic_cloth
