/// A virtual tool that the measured force of a hand moves, for devices that take positions in place of
/// forces.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// The tool and its limits. As parameters mass, damping, forces, speed and acceleration are those of the
/// hand; places are the cloth's frame's.
struct AdmittanceOptions {
  double mass = 0.5;               ///< [kg]
  double damping = 5.0;            ///< in free space a force F ends at the speed F/damping [N·s/m]
  double deadband = 0.0;           ///< taken off every measured force: what a sensor drifts by [N]
  double force_timeout = 0.05;     ///< after an older force the tool comes to rest [s]
  double max_speed = 0.5;          ///< [m/s]
  double max_acceleration = 20.0;  ///< also that of braking [m/s²]
  Vec3 start{0.0, 0.0, 0.2};       ///< of the tool, where the device does not say where it is [m]
  Vec3 workspace_low{-0.3, -0.3, 0.0}, workspace_high{0.3, 0.3, 0.4};  ///< corners of its box [m]
};

/// What a force sensor has measured.
struct ForceSample {
  double received = -1.0;     ///< steady clock [s]; < 0: none yet
  Vec3 force = Vec3::Zero();  ///< of the hand on the device, in the cloth's frame [N]
};

/// m dv/dt = F - b v, dx/dt = v, in steps that are implicit in what resists: b, and the local stiffness and
/// damping of what is touched. So it is stable for any mass and time step, and the steps only take energy.
class AdmittanceTool {
 public:
  explicit AdmittanceTool(const AdmittanceOptions& options) : options_(options), position_(options.start) {}

  /// Puts it somewhere else, at rest.
  void place(const Vec3& position);

  /// One step under `force` [N], all forces on it but its own damping, as they are where it stands.
  /// @param stiffness -dF/dx [N/m], @param damping -dF/dv [N·s/m]: symmetric, positive semi-definite
  /// @param time [s]
  void move(const Vec3& force, const Mat3& stiffness, const Mat3& damping, double time);

  /// One step towards rest, at max_acceleration.
  void brake(double time);

  const Vec3& position() const { return position_; }  ///< [m]
  const Vec3& velocity() const { return velocity_; }  ///< [m/s]

 private:
  void advance(double time);

  AdmittanceOptions options_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace haptic_cloth
