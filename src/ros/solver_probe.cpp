#include "ros/solver_probe.h"

#include "ros/steady_clock.h"

namespace haptic_cloth {

SolverProbe::SolverProbe(const NodeOptions& options, int number, Simulation& simulation, SharedProbe& shared)
    : number_(number), timeout_(options.probe_timeout), simulation_(simulation), shared_(shared) {}

void SolverProbe::takeDevice(double pace) {
  const StampedSample& newest = shared_.device_for_solver.read();
  device_ = newest.sample;
  orientation_ = newest.orientation;
  const bool fresh = device_.received >= 0.0 && steadyNow() - device_.received <= timeout_;
  if (fresh) {
    // In slow motion the hand is faster in simulated time than by the clock on the wall.
    simulation_.setDevice(number_, {device_.position, device_.velocity * pace, orientation_});
    closed_ = shared_.grasp_wanted;
    simulation_.setGrasp(number_, closed_);
  } else {
    // A device that comes back must not find its hand closed.
    open();
    if (present_) simulation_.removeDevice(number_);
  }
  present_ = fresh;
  shared_.present = fresh;
}

void SolverProbe::publishSnapshot(double pace) {
  const ProbeReport probe = simulation_.probe(number_);
  ProbeSnapshot snapshot;
  snapshot.taken = steadyNow();
  snapshot.device_received = device_.received;
  snapshot.device = probe.device;
  snapshot.proxy = probe.proxy;
  snapshot.proxy_velocity = probe.velocity / pace;
  snapshot.force = probe.force;
  snapshot.contact = probe.present && probe.contact;
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
  present_ = closed_ = false;
  shared_.present = false;
  shared_.grasp_wanted = false;
  shared_.grasp = GraspState::Open;
  // "None yet": the haptic thread ramps down and starts softly on the new cloth.
  shared_.snapshot.write(ProbeSnapshot());
}

ProbeView SolverProbe::view() const { return {simulation_.probe(number_), orientation_, shared_.grasp}; }

void SolverProbe::showGrasp() {
  const bool holds = closed_ && simulation_.probe(number_).grasps;
  shared_.grasp = holds ? GraspState::Holding : closed_ ? GraspState::Closed : GraspState::Open;
}

}  // namespace haptic_cloth
