/// Time integration of the nodes.
#pragma once

#include "mesh/field.h"

namespace haptic_cloth {

/// Backward Euler with air damping c, which acts on the velocity at the end of a step h:
///
///     m (1 + c h)/h² (x - x̂) = force,   x̂ = x⁰ + h v⁰/(1 + c h),   v = (x - x⁰)/h
///
/// The proxies of probes have no mass and do not use it.
class TimeIntegrator {
 public:
  TimeIntegrator(double time_step, double air_damping) : h_(time_step), air_damping_(air_damping) {}

  void setAirDamping(double air_damping) { air_damping_ = air_damping; }

  double timeStep() const { return h_; }

  /// Force per mass and distance from the inertial position [1/s²].
  double inertia() const { return (1.0 + air_damping_ * h_) / (h_ * h_); }

  /// Displacement of a step by inertia alone, over the velocity at its start [s].
  double inertialTime() const { return h_ / (1.0 + air_damping_ * h_); }

  /// Writes the positions x̂ that inertia alone leads to, for all nodes.
  void placeInertially(const Field& positions, const Field& velocities, Field& inertial) const {
    const double share = inertialTime();
    inertial.resize(positions.size());
    for (int c = 0; c < 3; ++c) {
      const auto &x = positions.coordinate(c), &v = velocities.coordinate(c);
      auto& ahead = inertial.coordinate(c);
      for (int n = 0; n < positions.size(); ++n) ahead[n] = x[n] + share * v[n];
    }
  }

  /// Writes the velocities at the end of a step from its start and end, for all nodes.
  void updateVelocities(const Field& before, const Field& after, Field& velocities) const {
    for (int c = 0; c < 3; ++c) {
      const auto &end = after.coordinate(c), &start = before.coordinate(c);
      auto& velocity = velocities.coordinate(c);
      for (int n = 0; n < after.size(); ++n) velocity[n] = (end[n] - start[n]) / h_;
    }
  }

 private:
  double h_;            ///< [s]
  double air_damping_;  ///< c [1/s]
};

}  // namespace haptic_cloth
