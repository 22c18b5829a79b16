#include <algorithm>

#include "haptic_cloth/error.h"
#include "haptic_cloth/haptic_session.h"
#include "haptics/clock_keeper.h"
#include "haptics/freshness.h"
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

/// Place of the proxy where spring and damper of the coupling balance the cloth's force on the probe [m]. A
/// solve that was cut short leaves a proxy that carries cloth farther behind its device.
Vec3 balancedProxy(const HapticOptions& options, const ProbeReport& probe, const Vec3& device_velocity) {
  const Vec3 spring = probe.force - options.coupling_damping * (probe.velocity - device_velocity);
  return probe.device + spring / options.coupling_stiffness;
}

}  // namespace

ProbeSession::ProbeSession(const Scene& scene, int probe, const HapticOptions& options, bool is_tool)
    : number_(probe),
      is_tool_(is_tool),
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
  const double time_step = std::max(1, length) * simulation.scene().solver.time_step;
  const HapticOptions& options = options_for_solver_.read();
  const bool first = step_interval_->begin(now, time_step, options.snapshot_timeout);
  simulation.setCoupling(number_, options.coupling_stiffness, options.coupling_damping);
  takeDevice(simulation, options, time_step, first, now);
}

/// @param first the step is the first after a pause or a stall
void ProbeSession::takeDevice(Simulation& simulation, const HapticOptions& options, double time_step,
                              bool first, double now) {
  const DeviceSample& newest = device_for_solver_.read();
  const bool fresh = newest.received >= 0.0 && isFresh(newest.received, now, options.probe_timeout);
  const double since = newest.received - newest_device_.received;
  const double way = (newest.position - newest_device_.position).norm();
  const double turn = newest.orientation.angularDistance(newest_device_.orientation);
  const bool turned = simulation.scene().probes[number_].isTurned(closed_);
  // Silence while no step was made is silence, too.
  const bool returns = newest.returns != newest_device_.returns;
  if (present_ && (returns || isJump(way, since) || (turned && isTurnJump(turn, since)))) {
    open(simulation);
    leave(simulation);
  }
  // All of the motion during a pause or a stall would go into this one step. A hand that rests keeps its
  // contact: one that moved no farther than the coupling stretches under the largest force.
  const bool far = options.coupling_stiffness * way > options.max_force;
  if (present_ && first && far && !catchesUp()) leave(simulation);
  const DeviceSample device = catchingUp(newest);
  if (fresh) {
    const double elapsed = device.received - step_device_.received;
    // By the moves between steps: without a filter's lag the damper feels no more than what the
    // proxy does not follow, and in slow motion the hand is as fast as it is in simulated time.
    const Vec3 moved = present_ ? Vec3(device.position - step_device_.position) : Vec3(Vec3::Zero());
    step_velocity_ = moved / time_step;
    simulation.setDevice(number_, {device.position, step_velocity_, device.orientation, elapsed});
    closed_ = grasp_wanted_;
    simulation.setGrasp(number_, closed_);
  } else {
    // A device that comes back must not find its hand closed.
    open(simulation);
    if (present_) simulation.removeDevice(number_);
  }
  present_ = fresh;
  newest_device_ = newest;
  step_device_ = device;
}

/// The newest pose or, of a tool and a probe that holds cloth, one on the way to it. After a late step the
/// hand has moved far; in one short step it would tear the cloth along at many times its speed.
DeviceSample ProbeSession::catchingUp(const DeviceSample& newest) const {
  constexpr double kFastest = 2.0;  // as a pin that was stopped [-]
  const double lag = newest.received - step_device_.received;
  const double made = std::max(kFastest * step_interval_->steadySeconds(), lag - ClockKeeper::kLongestLag);
  if (!present_ || !catchesUp() || made >= lag) return newest;
  const double share = made / lag;
  DeviceSample device = step_device_;
  device.received += made;
  device.position += share * (newest.position - device.position);
  device.orientation = device.orientation.slerp(share, newest.orientation);
  return device;
}

/// Takes the probe away from where it was. The learned behaviour of the cloth there is worth
/// nothing elsewhere, and the force starts softly.
void ProbeSession::leave(Simulation& simulation) {
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
  ProbeReport report = simulation.probe(number_);
  if (report.grasps && report.contact)
    report.proxy = balancedProxy(options_for_solver_.read(), report, step_velocity_);
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
  open(simulation);
  leave(simulation);
  step_interval_->interrupt();
  // "None yet": the force ramps down. A tick that misses it still starts softly on another cloth.
  snapshot_.write(ProbeSnapshot());
}

}  // namespace haptic_cloth
