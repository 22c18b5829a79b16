#include "sim/energy_balance.h"

#include <algorithm>

namespace haptic_cloth {

EnergyBalance::EnergyBalance(const Cloth& cloth, const ClothObjective& solved) {
  initial_ = supplied_ = report(cloth, solved).total();
}

void EnergyBalance::beginStep(const ClothObjective& last) {
  created_by_mesh_ = created_by_samples_ = returned_by_slip_ = 0.0;
  pin_work_ = pin_drag_ = 0.0;
  contact_before_ = last.contactEnergy();
  layers_before_ = last.layerEnergy();
  friction_before_ = last.frictionPotential();
}

void EnergyBalance::noteStart(const StepSolver::Start& start, bool solids_move) {
  // Contact is sampled again in each step: what that adds to the contact energy, beside the work of
  // ejecting cloth, must not become motion. If solids move, what it adds there cannot be told from their
  // work. The same holds for elastic slip, which is more under a smaller normal force; the last step's
  // potential also holds what slid, so a smaller one now says nothing.
  friction_start_ = solids_move ? 0.0 : start.friction;
  const double slip = std::max(0.0, start.friction - friction_before_);
  created_by_samples_ = start.layers - layers_before_;
  if (!solids_move)
    created_by_samples_ +=
        start.contact - start.layers - (contact_before_ - layers_before_) - ejection_work_ + slip;
  energy_before_ = start.energy - std::max(0.0, created());
}

double EnergyBalance::guard(double kinetic_before, double gravity_work, const ClothObjective& solved,
                            bool converged, Cloth& cloth) {
  const double spent = solved.storedAndLost(), kinetic = cloth.kineticEnergy();
  double allowed = std::max(0.0, energy_before_ + kinetic_before + gravity_work + pin_work_ - spent);
  // The noise of cloth that nearly rests must fade.
  const bool moves = kinetic > 0.5 * cloth.mass() * Cloth::kSlow * Cloth::kSlow;
  if (converged && moves) allowed += balanceUndone(solved.workUndone(), kinetic - allowed);
  if (kinetic <= allowed) return 1.0;
  const double scale = cloth.limitKineticEnergy(allowed);
  pin_work_ += (1.0 - scale * scale) * cloth.pinnedKineticEnergy();  // what moves the pins pays their share
  return scale;
}

/// The forces that a converged solve leaves undone would have done work. Motion that lacks it may have it
/// from a later step that did too much. If only the latter were taken back, small swings would fade.
/// @param work that was not done, negative: too much [J]
/// @param excess kinetic energy above what is allowed [J]  @return part of the excess that is kept [J]
double EnergyBalance::balanceUndone(double work, double excess) {
  if (work > 0.0) {
    undone_ += std::clamp(-excess, 0.0, work);
    return 0.0;
  }
  const double kept = std::clamp(excess, 0.0, std::min(-work, undone_));
  undone_ -= kept;
  return kept;
}

void EnergyBalance::update(const Scene& scene, const ClothObjective& solved, const ContactSet& contacts,
                           Probes& probes) {
  returned_by_slip_ = std::max(0.0, friction_start_ - solved.frictionPotential());
  for (int k = 0; k < probes.count(); ++k) {
    const ProbeStep& made = solved.probeSteps()[k];
    const Probes::Coupled before = probes.replaceCoupling(k, made.present ? solved.couplingEnergy(k) : 0.0);
    supplied_ -= before.energy;
    if (!made.present) continue;
    const ProbeOptions& options = scene.probes[k];
    const double stiffness = options.coupling_stiffness;
    supplied_ += 0.5 * stiffness * (before.device - made.proxy).squaredNorm();  // gains may have changed
    const Vec3 slip = made.device_velocity - probes.reports()[k].velocity;
    supplied_ += stiffness * (made.device - solved.proxy(k)).dot(made.device - before.device) +
                 options.coupling_damping * solved.timeStep() * slip.dot(made.device_velocity);
    if (!made.turns) continue;
    const double spring = TurnSpring(made.orientation, before.orientation).energy();
    supplied_ +=
        turnRadiusSquared(options) * stiffness * spring - solved.couplingTorque(k).dot(made.device_turn);
  }
  supplied_ += contacts.workOfSolids() + ejection_work_ + pin_work_ + pin_drag_;
  ejection_work_ = contacts.ejectionWork();
}

EnergyReport EnergyBalance::report(const Cloth& cloth, const ClothObjective& solved) const {
  EnergyReport e = cloth.motionEnergy();
  const InternalEnergy::Energy stored = cloth.storedEnergy(solved.fabricEnergy());
  e.stretch = stored.stretch;
  e.bend = stored.bend;
  e.shear = stored.shear;
  e.contact = solved.contactEnergy();
  e.coupling = solved.couplingEnergy();
  e.work = supplied_ - initial_;
  e.dissipated = supplied_ - e.total();
  return e;
}

void EnergyBalance::serialize(Archive& archive) {
  archive("supplied", supplied_);
  archive("undone", undone_);
  archive.check(undone_ >= 0.0, "undone", "must be >= 0");
  archive("ejection_work", ejection_work_);
}

}  // namespace haptic_cloth
