#include "haptics/solver_probe.h"

namespace haptic_cloth {

void SolverProbe::takeDevice(Simulation& simulation, double now) {
  const DeviceSample& device = exchange_.device_for_solver.read();
  const bool fresh = device.received >= 0.0 && now - device.received <= timeout_;
  const double elapsed = device.received - device_.received;
  if (present_ && isJump((device.position - device_.position).norm(), elapsed)) leave(simulation);
  if (fresh) {
    // By the moves between steps: without a filter's lag the damper feels no more than what the
    // proxy does not follow, and in slow motion the hand is as fast as it is in simulated time.
    const Vec3 moved = present_ ? Vec3(device.position - device_.position) : Vec3(Vec3::Zero());
    const double time_step = simulation.scene().solver.time_step;
    simulation.setDevice(number_, {device.position, moved / time_step, device.orientation, elapsed});
    closed_ = exchange_.grasp_wanted;
    simulation.setGrasp(number_, closed_);
  } else {
    // A device that comes back must not find its hand closed.
    open(simulation);
    if (present_) simulation.removeDevice(number_);
  }
  present_ = fresh;
  exchange_.present = fresh;
  device_ = device;
}

/// Takes the probe away from where it was. The learned behaviour of the cloth there is worth
/// nothing elsewhere, and the force starts softly.
void SolverProbe::leave(Simulation& simulation) {
  open(simulation);
  simulation.removeDevice(number_);
  tracker_.reset();
  present_ = false;
  ++cloth_;
}

void SolverProbe::publishSnapshot(const Simulation& simulation, double pace, double now) {
  ProbeSnapshot snapshot = tracker_.update(simulation.probe(number_), device_, pace, now);
  snapshot.cloth = cloth_;
  exchange_.snapshot.write(snapshot);
  showGrasp(simulation);
}

void SolverProbe::open(Simulation& simulation) {
  exchange_.grasp_wanted = false;
  if (!closed_) return;
  closed_ = false;
  simulation.setGrasp(number_, false);
  exchange_.grasp = GraspState::Open;
}

void SolverProbe::forget() {
  tracker_.reset();
  present_ = closed_ = false;
  exchange_.present = false;
  exchange_.grasp_wanted = false;
  exchange_.grasp = GraspState::Open;
  // "None yet": the haptic thread ramps down. Should it miss that, it still starts softly on
  // another cloth.
  ++cloth_;
  exchange_.snapshot.write(ProbeSnapshot());
}

ProbeView SolverProbe::view(const Simulation& simulation) const {
  return {simulation.probe(number_), device_.orientation, exchange_.grasp};
}

void SolverProbe::showGrasp(const Simulation& simulation) {
  const bool holds = closed_ && simulation.probe(number_).grasps;
  exchange_.grasp = holds ? GraspState::Holding : closed_ ? GraspState::Closed : GraspState::Open;
}

}  // namespace haptic_cloth
