/// Virtual tool moved by the measured force of a hand, for devices that accept positions instead of
/// forces.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Tool and limits. As parameters, mass, damping, forces, speed and acceleration refer to the hand;
/// positions are in the frame of the cloth.
struct AdmittanceOptions {
  double mass = 0.5;               ///< [kg]
  double damping = 5.0;            ///< a force F leads to the speed F/damping in free space [N·s/m]
  double deadband = 0.0;           ///< subtracted from each measured force; covers drift [N]
  double force_timeout = 0.05;     ///< the tool brakes if the last force is older [s]
  double max_speed = 0.5;          ///< [m/s]
  double max_acceleration = 20.0;  ///< largest acceleration, also for braking [m/s²]
  Vec3 start{0.0, 0.0, 0.2};       ///< initial position, if the device does not report its own [m]
  /// Corners of the workspace box [m].
  Vec3 workspace_low{-0.3, -0.3, 0.0}, workspace_high{0.3, 0.3, 0.4};
};

/// Measurement of a force sensor.
struct ForceSample {
  double received = -1.0;     ///< time of arrival, steady clock [s]; < 0: none yet
  Vec3 force = Vec3::Zero();  ///< force of the hand on the device, in the cloth's frame [N]
};

/// Tool with m dv/dt = F - b v, dx/dt = v. Steps are implicit in b and in the local stiffness and
/// damping of the contact. They are stable for any mass and time step, and only remove energy.
class AdmittanceTool {
 public:
  explicit AdmittanceTool(const AdmittanceOptions& options) : options_(options), position_(options.start) {}

  /// Changes mass, damping and limits. The tool keeps its place and its velocity.
  void setOptions(const AdmittanceOptions& options) { options_ = options; }

  /// Moves the tool to a position [m], at rest.
  void place(const Vec3& position);

  /// Makes one step under `force` [N]: all forces on the tool at its current position, except its
  /// own damping.
  /// @param stiffness -dF/dx [N/m], symmetric, positive semi-definite
  /// @param damping -dF/dv [N·s/m], symmetric, positive semi-definite
  /// @param time length of the step [s]
  void move(const Vec3& force, const Mat3& stiffness, const Mat3& damping, double time);

  /// Makes one step towards rest at max_acceleration.
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
