// Part of ClothWorld that balances energy.
#include <algorithm>
#include <cmath>

#include "sim/cloth_world.h"

namespace haptic_cloth {

/// Energy guard: limits the kinetic energy to `left` [J], the energy at the start of the step plus
/// the work of its inputs minus what is now stored or dissipated. Energy that a mesh change created
/// beyond the kinetic energy is not carried over to later steps: that debt would freeze cloth that
/// is about to buckle.
/// @return factor applied to the velocities, 1 if none was needed
double ClothWorld::guardEnergy(double left) {
  const double kinetic = kineticEnergy();
  const double allowed = std::max(0.0, left);
  if (kinetic <= allowed || kinetic == 0.0) return 1.0;
  const double scale = std::sqrt(allowed / kinetic);
  for (int n = 0; n < mesh.nodes(); ++n) velocities_.set(n, scale * velocities_[n]);
  return scale;
}

/// Adds the work of devices and obstacles. Devices work on spring and damper of their couplings;
/// removing a device removes the energy of its spring. Obstacles work by moving and by ejecting
/// cloth. Energy missing in the balance at the end of a step counts as dissipated, also after a
/// failed step.
void ClothWorld::account() {
  for (int k = 0; k < static_cast<int>(probes.size()); ++k) {
    const ProbeStep& made = objective.probeSteps()[k];
    double& coupling = memories_[k].coupling;
    supplied_ -= coupling;
    coupling = 0.0;
    if (!made.present) continue;
    const ProbeOptions& options = scene.probes[k];
    supplied_ += 0.5 * options.coupling_stiffness * (made.device - made.proxy).squaredNorm() +
                 options.coupling_damping * scene.solver.time_step *
                     (made.device_velocity - probes[k].velocity).dot(made.device_velocity);
    coupling = objective.couplingEnergy(k);
  }
  supplied_ += contacts.obstacleWork() + let_out_;
  let_out_ = contacts.letOutWork();
}

double ClothWorld::kineticEnergy() const {
  double kinetic = 0.0;
  for (int n = 0; n < mesh.active(); ++n) kinetic += 0.5 * mesh.mass[n] * velocities_[n].squaredNorm();
  return kinetic;
}

/// Kinetic energy and energy of gravity.
EnergyReport ClothWorld::measureMotion() const {
  EnergyReport e;
  e.kinetic = kineticEnergy();
  for (int n = 0; n < mesh.active(); ++n) e.gravity -= mesh.mass[n] * scene.gravity.dot(nodes_[n]);
  return e;
}

EnergyReport ClothWorld::energy() const {
  EnergyReport e = measureMotion();
  Sums parts;
  objective.internalEnergy(parts);
  const InternalEnergy::Energy stored =
      history_ ? internal.stored(nodes_) : InternalEnergy::Energy{parts[0], parts[1], parts[2]};
  e.stretch = stored.stretch;
  e.bend = stored.bend;
  e.shear = stored.shear;
  e.contact = parts[3];
  e.coupling = objective.couplingEnergy();
  e.work = supplied_ - initial_;
  e.dissipated = supplied_ - e.total();
  return e;
}

}  // namespace haptic_cloth
