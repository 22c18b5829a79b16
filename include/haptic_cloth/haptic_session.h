/// A haptic loop of two threads: one steps the simulation, the other drives the device at 1 kHz.
#pragma once

#include <memory>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// Connects one probe of a Simulation with an impedance device (pose in, force out).
///
///     solver's thread                        device's thread, every millisecond
///     ---------------                        ----------------------------------
///     session.beforeStep(simulation, now);   pose = read the device
///     simulation.step();                     wrench = session.tick(pose, now);
///     session.afterStep(simulation, now);    send wrench.force to the device
///
/// Each function belongs to one of these two threads; setGrasp() may be called from any. The
/// threads share values through mailboxes: neither waits for the other, and after construction
/// nothing is allocated. The Simulation belongs to the solver's thread alone. A scene with several
/// probes has a session for each.
///
/// Units are SI, poses and wrenches are in the world frame of the scene. `now` is in seconds on one
/// steady clock (std::chrono::steady_clock) for both threads.
class HapticSession {
 public:
  /// Takes the coupling's stiffness and damping from the scene, not from `options`.
  /// @param simulation is not kept
  /// @param probe number in the scene, from 0
  /// @param options rate of the ticks, limits of the force, time limits, passivity
  /// @throws InputError if there is no such probe or an option is not valid
  HapticSession(const Simulation& simulation, int probe, const HapticOptions& options = HapticOptions());
  ~HapticSession();
  HapticSession(const HapticSession&) = delete;
  HapticSession& operator=(const HapticSession&) = delete;

  // ---- on the solver's thread ----

  /// Hands the newest pose of the device to the simulation, just before step(). Without a pose for
  /// one second the probe leaves the scene; if the device jumps (isJump()), the probe lets go and
  /// enters the scene again at the new place.
  void beforeStep(Simulation& simulation, double now);

  /// Publishes for tick() what the step made of the probe, just after step().
  void afterStep(const Simulation& simulation, double now);

  /// Starts again after Simulation::reset() or loadState(): the probe lets go of the cloth, and the
  /// force starts softly.
  void restart(Simulation& simulation);

  // ---- on the device's thread ----

  /// Takes the device's pose and returns what the hand should feel.
  /// @param pose of the device [m]; ignored if it is not finite
  /// @param now when the pose was read [s]
  /// @param paused ramps the force to zero
  /// @return force [N] and torque about the probe's origin [N·m] on the probe. Always finite,
  /// limited in size and in rate, zero without contact; they ramp to zero if poses or steps stop
  /// coming (HapticOptions)
  Wrench tick(const Pose& pose, double now, bool paused = false);

  /// The same without a new pose, for a device that is slower than the ticks.
  Wrench tick(double now, bool paused = false);

  /// Why the last tick gave a force, or none.
  HapticStatus status() const;

  /// Closes or opens the probe. A closed one holds the cloth it touches. It opens by itself if
  /// the device jumps or falls silent, and at restart(). May be called from any thread.
  void setGrasp(bool closed);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptic_cloth
