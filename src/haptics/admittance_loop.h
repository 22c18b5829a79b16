/// Haptic tick of a probe with an admittance device: force in, pose out.
#pragma once

#include <optional>

#include "haptic_cloth/haptics.h"
#include "haptics/velocity_filter.h"

namespace haptic_cloth {

/// Virtual tool, the force of the cloth on it (HapticLoop, with its limits and passivity controller),
/// and the faults at which it has to stand still. Pure arithmetic on its own state: no clock, no lock,
/// no allocation.
class AdmittanceLoop {
 public:
  /// @throws InputError if an option is not valid
  explicit AdmittanceLoop(const HapticOptions& options);

  /// Does the same as HapticLoop::setOptions(). The tool keeps its place and its velocity.
  void setOptions(const HapticOptions& options, double unit);

  /// Sets the pose of the device [m], at which the tool starts. The tool turns as the device does: a force
  /// does not turn it. A device that is elsewhere would be sent away: so the tool goes there and stands still
  /// when the first position comes after the start, and when positions or forces come back after a silence of
  /// `probe_timeout`.
  /// @param received when it arrived [s]; ignored if that is not after the one before
  void place(const Pose& device, double received);

  /// Turns the tool.
  void turn(const Quat& orientation) { device_.orientation = orientation; }

  /// Makes one tick at `now` (steady clock [s]). The tool starts with the first force. It brakes and
  /// then stands still while the force or the snapshot is missing, stale or not finite, and during a
  /// pause. After that the force of the hand comes in softly.
  void tick(const ForceSample& hand, const ProbeSnapshot& snapshot, bool paused, double now);

  bool started() const { return started_; }

  /// The tool as the device of the probe. Its time of receipt is that of the last tick with a
  /// force that was not stale, so a tool whose hand is silent for long leaves the scene as a device does.
  const DeviceSample& device() const { return device_; }

  const Vec3& position() const { return tool_.position(); }  ///< target of the tool [m]
  const Vec3& reaction() const { return reaction_; }         ///< force of the cloth on the tool [N]
  const Vec3& torque() const { return cloth_.torque(); }     ///< its torque about the tool's origin [N·m]
  HapticStatus status() const { return status_; }
  double forceShare() const { return cloth_.forceShare(); }  ///< see HapticLoop
  bool atRest() const { return tool_.velocity().isZero(0.0); }

 private:
  /// Where the tool touched the cloth: the proxy, and the way of the coupling's force from there. A tool that
  /// is pressed is on the inner side.
  struct Touch {
    Vec3 place, out;
    bool isInside(const Vec3& x) const { return (x - place).dot(out) < 0.0; }
  };

  /// Where the device said that it is.
  struct Place {
    Vec3 position = Vec3::Zero();  ///< [m]
    double received = -1.0;        ///< [s]; < 0: never
  };

  void goToDevice();
  void watchTouch(const ProbeSnapshot& snapshot);
  Vec3 wayOut(const ProbeSnapshot& snapshot) const;
  void moveTool(const ForceSample& hand, const ProbeSnapshot& snapshot, double elapsed);

  HapticOptions options_;
  AdmittanceTool tool_;
  HapticLoop cloth_;
  DeviceSample device_;
  VelocityFilter turn_filter_;
  Quat turned_from_ = Quat::Identity();  ///< orientation at the last tick
  Vec3 reaction_ = Vec3::Zero();
  HapticStatus status_ = HapticStatus::NoForce;
  std::optional<Touch> touch_;  ///< now, or before a fault
  std::optional<Touch> lost_;   ///< that a fault ended, until the tool touches there again or is out
  bool started_ = false;
  Place reported_;      ///< by the device
  double left_ = -1.0;  ///< receipt of device_ when the tool last went to the device [s]; < 0: never
  double last_tick_ = -1.0;
  double soft_ = 0.0;  ///< 0..1, share of the hand's force
};

}  // namespace haptic_cloth
