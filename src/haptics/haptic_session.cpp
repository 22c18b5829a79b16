#include "haptic_cloth/haptic_session.h"

#include "haptic_cloth/error.h"
#include "haptics/solver_probe.h"
#include "haptics/step_pace.h"
#include "haptics/velocity_filter.h"

namespace haptic_cloth {
namespace {

const ProbeOptions& probeOf(const Scene& scene, int number) {
  if (number < 0 || number >= static_cast<int>(scene.probes.size())) {
    throw InputError("haptic session", "probe", std::to_string(number),
                     "must be a probe of the scene, which has " + std::to_string(scene.probes.size()));
  }
  return scene.probes[number];
}

HapticOptions coupledAs(const ProbeOptions& probe, HapticOptions options) {
  options.coupling_stiffness = probe.coupling_stiffness;
  options.coupling_damping = probe.coupling_damping;
  return options;
}

bool isPose(const Pose& pose) {
  const Eigen::Vector4d turn = pose.orientation.coeffs();
  return pose.position.allFinite() && turn.allFinite() && turn.norm() > 0.0;
}

}  // namespace

class HapticSession::Implementation {
 public:
  Implementation(const Scene& scene, int number, const HapticOptions& options)
      : longest_step(options.snapshot_timeout),
        loop(coupledAs(probeOf(scene, number), options)),
        filter(kVelocityTimeConstant, options.pose_timeout),
        probe(number, kProbeTimeout, exchange),
        pace(scene.solver.time_step),
        probe_number(number) {}

  double longest_step;  ///< [s]; after a longer one the solver's thread has paused
  ProbeExchange exchange;

  HapticLoop loop;  ///< device's thread
  VelocityFilter filter;
  DeviceSample device;

  SolverProbe probe;  ///< solver's thread
  StepPace pace;
  int probe_number;
  double step_start = 0.0;  ///< of the last step [s]
};

HapticSession::HapticSession(const Simulation& simulation, int probe, const HapticOptions& options)
    : implementation_(std::make_unique<Implementation>(simulation.scene(), probe, options)) {}

HapticSession::~HapticSession() = default;

void HapticSession::beforeStep(Simulation& simulation, double now) {
  Implementation& own = *implementation_;
  if (!(now - own.step_start <= own.longest_step)) own.pace.interrupt();
  own.step_start = now;
  own.pace.begin(now);
  own.probe.takeDevice(simulation, now);
}

void HapticSession::afterStep(const Simulation& simulation, double now) {
  implementation_->probe.publishSnapshot(simulation, implementation_->pace.seconds(), now);
}

void HapticSession::restart(Simulation& simulation) {
  simulation.removeDevice(implementation_->probe_number);
  implementation_->probe.forget();
  implementation_->pace.interrupt();
}

Wrench HapticSession::tick(const Pose& pose, double now, bool paused) {
  Implementation& own = *implementation_;
  if (isPose(pose)) {
    own.device.received = own.device.stamp = now;
    own.device.position = pose.position;
    own.device.velocity = own.filter.update(pose.position, now);
    own.device.orientation = pose.orientation.normalized();
    own.exchange.device_for_solver.write(own.device);
  }
  return tick(now, paused);
}

Wrench HapticSession::tick(double now, bool paused) {
  Implementation& own = *implementation_;
  Wrench wrench;
  wrench.force = own.loop.tick(own.device, own.exchange.snapshot.read(), paused, now);
  wrench.torque = own.loop.torque();
  return wrench;
}

HapticStatus HapticSession::status() const { return implementation_->loop.status(); }

void HapticSession::setGrasp(bool closed) { implementation_->exchange.grasp_wanted = closed; }

}  // namespace haptic_cloth
