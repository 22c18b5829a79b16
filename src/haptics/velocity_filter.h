/// Velocity of a device from its poses, or its angular velocity.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// First-order low pass on the difference quotient, for unevenly spaced samples. Its memory decays with time,
/// not with samples, so two samples that arrive in one burst (dt near 0) add Δx/τ at most, never Δx/dt.
class VelocityFilter {
 public:
  /// @param time_constant τ [s], > 0
  /// @param gap after a longer pause between samples the filter starts from rest, as after a jump [s]
  VelocityFilter(double time_constant, double gap) : time_constant_(time_constant), gap_(gap) {}

  /// The same as the constructor's, from the next sample on.
  void setTimes(double time_constant, double gap) {
    time_constant_ = time_constant;
    gap_ = gap;
  }

  /// @param moved since the last pose [m], or turn since then [rad]
  /// @param jumped the device has not moved there: the filter starts from rest
  /// @param time of receipt, steady clock [s]
  /// @return velocity [m/s], or angular velocity [rad/s]
  Vec3 update(const Vec3& moved, bool jumped, double time);

 private:
  double time_constant_;
  double gap_;
  double last_time_ = -1.0;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace haptic_cloth
