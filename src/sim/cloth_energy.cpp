// The part of ClothWorld that keeps account of energy.
#include <algorithm>
#include <cmath>

#include "sim/cloth_world.h"

namespace haptic_cloth {

/// Passivity: what moves may not hold more kinetic energy than is left [J] of what the step began with, the
/// work of its inputs included. What a mesh change created beyond what there is motion to take it from stays:
/// owed by later steps it would freeze cloth that is about to buckle. @return scale of the velocities, 1
/// where nothing was to do
double ClothWorld::guardEnergy(double left) {
  const double kinetic = kineticEnergy();
  const double allowed = std::max(0.0, left);
  if (kinetic <= allowed || kinetic == 0.0) return 1.0;
  const double scale = std::sqrt(allowed / kinetic);
  for (int n = 0; n < mesh.nodes(); ++n) velocities_.set(n, scale * velocities_[n]);
  return scale;
}

/// What the devices do: they work on spring and damper of their couplings; taking one away takes the spring's
/// energy with it. Obstacles work where they move and where they let cloth out. What is missing in the
/// balance at the end of a step was dissipated, in a failed step too.
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

/// Kinetic energy and that of gravity.
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
