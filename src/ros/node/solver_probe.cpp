#include "ros/node/solver_probe.h"

#include "ros/node/steady_clock.h"

namespace haptic_cloth {

SolverProbe::SolverProbe(const NodeOptions& options, int number, Simulation& simulation, SharedProbe& shared)
    : number_(number), timeout_(options.probe_timeout), simulation_(simulation), shared_(shared) {}

void SolverProbe::takeDevice() {
  const StampedSample& newest = shared_.device_for_solver.read();
  const DeviceSample& device = newest.sample;
  orientation_ = newest.orientation;
  const bool fresh = device.received >= 0.0 && steadyNow() - device.received <= timeout_;
  const double elapsed = device.received - device_.received;
  if (present_ && isJump((device.position - device_.position).norm(), elapsed)) leave();
  if (fresh) {
    // By the moves between steps: without a filter's lag the damper feels no more than what the proxy does
    // not follow, and in slow motion the hand is as fast as it is in simulated time.
    const Vec3 moved = present_ ? Vec3(device.position - device_.position) : Vec3(Vec3::Zero());
    const double time_step = simulation_.scene().solver.time_step;
    simulation_.setDevice(number_, {device.position, moved / time_step, orientation_, elapsed});
    closed_ = shared_.grasp_wanted;
    simulation_.setGrasp(number_, closed_);
  } else {
    // A device that comes back must not find its hand closed.
    open();
    if (present_) simulation_.removeDevice(number_);
  }
  present_ = fresh;
  shared_.present = fresh;
  device_ = device;
}

/// What was learned of the cloth there is worth nothing elsewhere, and the force starts softly.
void SolverProbe::leave() {
  open();
  simulation_.removeDevice(number_);
  tracker_.reset();
  present_ = false;
  ++cloth_;
}

void SolverProbe::publishSnapshot(double pace) {
  ProbeSnapshot snapshot = tracker_.update(simulation_.probe(number_), device_, pace, steadyNow());
  snapshot.cloth = cloth_;
  shared_.snapshot.write(snapshot);
  showGrasp();
}

void SolverProbe::open() {
  shared_.grasp_wanted = false;
  if (!closed_) return;
  closed_ = false;
  simulation_.setGrasp(number_, false);
  shared_.grasp = GraspState::Open;
}

void SolverProbe::forget() {
  tracker_.reset();
  present_ = closed_ = false;
  shared_.present = false;
  shared_.grasp_wanted = false;
  shared_.grasp = GraspState::Open;
  // "None yet": the haptic thread ramps down. Should it miss that, it still starts softly on another cloth.
  ++cloth_;
  shared_.snapshot.write(ProbeSnapshot());
}

ProbeView SolverProbe::view() const { return {simulation_.probe(number_), orientation_, shared_.grasp}; }

void SolverProbe::showGrasp() {
  const bool holds = closed_ && simulation_.probe(number_).grasps;
  shared_.grasp = holds ? GraspState::Holding : closed_ ? GraspState::Closed : GraspState::Open;
}

}  // namespace haptic_cloth
