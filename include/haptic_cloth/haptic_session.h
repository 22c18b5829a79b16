/// Haptic loops of two threads: one steps the simulation, the other drives the device at 1 kHz.
#pragma once

#include <atomic>
#include <memory>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

class AdmittanceLoop;
class ProbeTracker;
class StepInterval;
class VelocityFilter;

/// Grasp of a probe on the cloth that it touches.
enum class GraspState { Open, Closed, Holding };

/// Connects one probe of a Simulation with its device. This class is the part that both kinds of
/// device share; HapticSession and AdmittanceSession add the ticks.
///
///     solver's thread                        device's thread, every millisecond
///     ---------------                        ----------------------------------
///     session.beforeStep(simulation, now);   pose = read the device
///     simulation.step();                     wrench = session.tick(pose, now);
///     session.afterStep(simulation, now);    send wrench.force to the device
///
/// Each function belongs to the thread that its section names. The threads share values through
/// mailboxes: neither waits for the other, and the device's thread allocates nothing. The
/// Simulation belongs to the solver's thread alone. A scene with several probes has a session for
/// each. StepPacer (step_pacer.h) says when a step is due and how long it is.
///
/// Units are SI, poses and wrenches are in the world frame of the scene. All times are >= 0, in seconds
/// on one steady clock (std::chrono::steady_clock) for both threads. What was received later than `now` by
/// more than its timeout is of another clock, and counts as missing.
class ProbeSession {
 public:
  ProbeSession(const ProbeSession&) = delete;
  ProbeSession& operator=(const ProbeSession&) = delete;

  // ---- on the solver's thread ----

  /// Hands the newest pose, grasp and coupling to the simulation, just before step(). Without a pose
  /// for HapticOptions::probe_timeout the probe leaves the scene; if the device jumps (isJump()),
  /// the probe lets go and enters the scene again at the new place. After pause(), or if no step began
  /// for HapticOptions::snapshot_timeout, a probe that holds no cloth enters the scene again, too, if the
  /// device has moved by more than max_force / coupling_stiffness, but not the tool of an admittance device.
  /// After a late step a tool, and a hand that holds cloth, moves at most twice as fast as it did and catches
  /// up in later steps; what it lags behind by more than 0.1 s is made up at once.
  /// @param length of the step, as for Simulation::step()
  void beforeStep(Simulation& simulation, double now, int length = 1);

  /// Publishes for the ticks what the step made of the probe, just after step().
  void afterStep(const Simulation& simulation, double now);

  /// Lets go of the cloth. Call it when no steps are made for a while.
  void pause(Simulation& simulation);

  /// Starts again after Simulation::reset() or loadState(): the probe lets go of the cloth, and the
  /// force starts softly.
  void restart(Simulation& simulation);

  /// Orientation of the device in the last step.
  const Quat& orientation() const { return step_device_.orientation; }

  // ---- on the device's thread ----

  /// Options in use, with the coupling.
  const HapticOptions& options() const { return options_; }

  // ---- on any thread ----

  /// Closes or opens the probe. A closed one holds the cloth it touches. It opens by itself if the
  /// device jumps or falls silent, at pause() and at restart().
  void setGrasp(bool closed) { grasp_wanted_ = closed; }

  GraspState grasp() const { return grasp_; }

  /// Tells whether the last step had a pose of the device.
  bool isPresent() const { return present_; }

 protected:
  /// @param is_tool the device follows the cloth, and is never elsewhere after a stall
  ProbeSession(const Scene& scene, int probe, const HapticOptions& options, bool is_tool);
  ~ProbeSession();

  // On the device's thread.
  void takeOptions(const HapticOptions& options);
  void sendDevice(const DeviceSample& device) { device_for_solver_.write(device); }
  const ProbeSnapshot& newestSnapshot() { return snapshot_.read(); }

 private:
  void takeDevice(Simulation& simulation, const HapticOptions& options, double time_step, bool first,
                  double now);
  DeviceSample catchingUp(const DeviceSample& newest) const;
  void leave(Simulation& simulation);
  void open(Simulation& simulation);

  /// Tells whether the probe moves on from where it was after a stall.
  bool catchesUp() const { return is_tool_ || grasp_ == GraspState::Holding; }

  int number_;    ///< of the probe in the scene
  bool is_tool_;  ///< see the constructor

  Mailbox<HapticOptions> options_for_solver_;  ///< device's thread → solver's thread
  Mailbox<DeviceSample> device_for_solver_;    ///< device's thread → solver's thread
  Mailbox<ProbeSnapshot> snapshot_;            ///< solver's thread → device's thread
  std::atomic<bool> grasp_wanted_{false};      ///< set from any thread; the solver opens it
  std::atomic<bool> present_{false};           ///< written by the solver's thread
  std::atomic<GraspState> grasp_{GraspState::Open};

  HapticOptions options_;  ///< device's thread

  // Solver's thread.
  bool closed_ = false;
  int cloth_ = 0;                      ///< see ProbeSnapshot
  DeviceSample newest_device_;         ///< received before the current step
  DeviceSample step_device_;           ///< of the current step
  Vec3 step_velocity_ = Vec3::Zero();  ///< of the device in that step, in simulated time [m/s]
  std::unique_ptr<ProbeTracker> tracker_;
  std::unique_ptr<StepInterval> step_interval_;
};

/// Session with an impedance device: pose in, force out.
class HapticSession : public ProbeSession {
 public:
  /// Takes stiffness and damping of the coupling from the scene, not from `options`.
  /// @param probe number in the scene, from 0
  /// @param options rate of the ticks, limits of the force, time limits, passivity
  /// @throws InputError if there is no such probe or an option is not valid
  HapticSession(const Scene& scene, int probe, const HapticOptions& options = HapticOptions());
  ~HapticSession();

  // ---- on the device's thread ----

  /// Takes the device's pose and returns what the hand should feel.
  /// @param pose of the device [m]; ignored if it is not finite or beyond kFarthestPose
  /// @param now when the pose was read [s]
  /// @param paused ramps the force to zero
  /// @return force [N] and torque about the probe's origin [N·m] on the probe. Always finite,
  /// limited in size and in rate, zero without contact; they ramp to zero if poses or steps stop
  /// coming (HapticOptions)
  Wrench tick(const Pose& pose, double now, bool paused = false);

  /// Does the same without a new pose, for a device that is slower than the ticks.
  Wrench tick(double now, bool paused = false);

  /// Sets the pose for the next ticks, for a device whose poses come over a network.
  /// @param pose [m]; ignored if it is not finite or beyond kFarthestPose
  /// @param received when it arrived [s]; ignored if that is not later than the one before
  void setPose(const Pose& pose, double received);

  /// Changes options from the next tick on, the coupling from the next step on too: begin with a copy of
  /// options(), which has the coupling in use. The force continues within max_force_rate. The check allocates
  /// memory.
  /// @param unit see HapticLoop::setOptions() [-]
  /// @throws InputError if an option or the unit is not valid; then nothing has changed
  void setOptions(const HapticOptions& options, double unit = 1.0);

  /// Does the same without the check, and allocates nothing.
  /// @pre the options are valid (validateHapticOptions())
  void setCheckedOptions(const HapticOptions& options, double unit);

  /// Tells why the last tick gave a force, or none.
  HapticStatus status() const { return loop_.status(); }

  /// See HapticLoop::energy() [J].
  double energy() const { return loop_.energy(); }

  /// See HapticLoop::forceShare() [-].
  double forceShare() const { return loop_.forceShare(); }

 private:
  HapticLoop loop_;
  std::unique_ptr<VelocityFilter> filter_, turn_filter_;
  DeviceSample device_;
};

/// Session with an admittance device: force in, pose out. A virtual tool (AdmittanceOptions) moves
/// under the force of the hand and that of the cloth; the device follows it.
class AdmittanceSession : public ProbeSession {
 public:
  /// See HapticSession.
  AdmittanceSession(const Scene& scene, int probe, const HapticOptions& options = HapticOptions());
  ~AdmittanceSession();

  // ---- on the device's thread ----

  /// Takes the measured force and returns where the device should go.
  /// @param force of the hand on the device [N]; one that is not finite counts as missing
  /// @param now when the force was measured [s]
  /// @param paused brings the tool to rest
  /// @return pose of the tool [m]. The tool starts with the first force, stays in its workspace and
  /// below its limits of speed and acceleration. It stops if forces or steps stop coming
  Pose tick(const Vec3& force, double now, bool paused = false);

  /// Does the same without a new force.
  Pose tick(double now, bool paused = false);

  /// Sets the force for the next ticks, for a sensor whose values come over a network.
  /// @param received when it arrived [s]; ignored if that is before the one before
  void setForce(const Vec3& force, double received);

  /// Sets the pose of a device that reports it. The tool starts at this position [m]
  /// (otherwise at AdmittanceOptions::start; the first pose brings it to the device even then) and turns with
  /// the device (otherwise it has the orientation of the scene's probe). After a silence of
  /// HapticOptions::probe_timeout it starts again where the device is. Ignored if it is not finite or
  /// beyond kFarthestPose.
  /// @param received when it arrived [s]; ignored if that is not after the one before
  void setPose(const Pose& pose, double received);

  /// Does the same as HapticSession::setOptions(). The tool keeps its place and its velocity.
  void setOptions(const HapticOptions& options, double unit = 1.0);

  /// See HapticSession.
  void setCheckedOptions(const HapticOptions& options, double unit);

  bool hasStarted() const;      ///< whether there was a force
  bool isAtRest() const;        ///< whether the tool stands still
  Wrench reaction() const;      ///< of the cloth on the tool at the last tick [N], [N·m]
  HapticStatus status() const;  ///< why the tool moves, or stands still
  double forceShare() const;    ///< see HapticLoop::forceShare() [-]

 private:
  std::unique_ptr<AdmittanceLoop> loop_;
  ForceSample hand_;
};

}  // namespace haptic_cloth
