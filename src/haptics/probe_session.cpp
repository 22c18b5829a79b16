#include "haptic_cloth/error.h"
#include "haptic_cloth/haptic_session.h"
#include "haptics/probe_tracker.h"
#include "haptics/step_interval.h"

namespace haptic_cloth {
namespace {

HapticOptions coupledAs(const Scene& scene, int probe, HapticOptions options) {
  if (probe < 0 || probe >= static_cast<int>(scene.probes.size())) {
    throw InputError("haptic session", "probe", std::to_string(probe),
                     "must be a probe of the scene, which has " + std::to_string(scene.probes.size()));
  }
  options.coupling_stiffness = scene.probes[probe].coupling_stiffness;
  options.coupling_damping = scene.probes[probe].coupling_damping;
  return options;
}

}  // namespace

ProbeSession::ProbeSession(const Scene& scene, int probe, const HapticOptions& options)
    : number_(probe),
      tracker_(std::make_unique<ProbeTracker>()),
      step_interval_(std::make_unique<StepInterval>()) {
  takeOptions(coupledAs(scene, probe, options));
}

ProbeSession::~ProbeSession() = default;

void ProbeSession::takeOptions(const HapticOptions& options) {
  options_ = options;
  options_for_solver_.write(options);
}

void ProbeSession::beforeStep(Simulation& simulation, double now, int length) {
  const double time_step = length * simulation.scene().solver.time_step;
  const HapticOptions& options = options_for_solver_.read();
  step_interval_->begin(now, time_step, options.snapshot_timeout);
  simulation.setCoupling(number_, options.coupling_stiffness, options.coupling_damping);
  takeDevice(simulation, options.probe_timeout, time_step, now);
}

void ProbeSession::takeDevice(Simulation& simulation, double timeout, double time_step, double now) {
  const DeviceSample& device = device_for_solver_.read();
  const bool fresh = device.received >= 0.0 && now - device.received <= timeout;
  const double elapsed = device.received - step_device_.received;
  if (present_ && isJump((device.position - step_device_.position).norm(), elapsed)) leave(simulation);
  if (fresh) {
    // By the moves between steps: without a filter's lag the damper feels no more than what the
    // proxy does not follow, and in slow motion the hand is as fast as it is in simulated time.
    const Vec3 moved = present_ ? Vec3(device.position - step_device_.position) : Vec3(Vec3::Zero());
    simulation.setDevice(number_, {device.position, moved / time_step, device.orientation, elapsed});
    closed_ = grasp_wanted_;
    simulation.setGrasp(number_, closed_);
  } else {
    // A device that comes back must not find its hand closed.
    open(simulation);
    if (present_) simulation.removeDevice(number_);
  }
  present_ = fresh;
  step_device_ = device;
}

/// Takes the probe away from where it was. The learned behaviour of the cloth there is worth
/// nothing elsewhere, and the force starts softly.
void ProbeSession::leave(Simulation& simulation) {
  open(simulation);
  simulation.removeDevice(number_);
  tracker_->reset();
  present_ = false;
  ++cloth_;
}

void ProbeSession::open(Simulation& simulation) {
  grasp_wanted_ = false;
  if (!closed_) return;
  closed_ = false;
  simulation.setGrasp(number_, false);
  grasp_ = GraspState::Open;
}

void ProbeSession::afterStep(const Simulation& simulation, double now) {
  const ProbeReport report = simulation.probe(number_);
  ProbeSnapshot snapshot = tracker_->update(report, step_device_, step_interval_->seconds(), now);
  snapshot.cloth = cloth_;
  snapshot_.write(snapshot);
  const bool holds = closed_ && report.grasps;
  grasp_ = holds ? GraspState::Holding : closed_ ? GraspState::Closed : GraspState::Open;
}

void ProbeSession::pause(Simulation& simulation) {
  open(simulation);
  step_interval_->interrupt();
}

void ProbeSession::restart(Simulation& simulation) {
  leave(simulation);
  step_interval_->interrupt();
  // "None yet": the force ramps down. A tick that misses it still starts softly on another cloth.
  snapshot_.write(ProbeSnapshot());
}

}  // namespace haptic_cloth
