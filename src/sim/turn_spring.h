/// Law by which a coupling resists turns of a probe.
#pragma once

#include "contact/proxy.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Arm at which the largest force of a small device has its largest torque [m].
constexpr double kTurnArm = 0.03;

/// The coupling resists turns as if its spring and damper were spread over the probe, and over that arm: mean
/// square distance from the axis [m²].
inline double turnRadiusSquared(const ProbeOptions& probe) {
  return kTurnArm * kTurnArm + probe.length * probe.length / 12.0;
}

/// Spring of a coupling against turns, over its stiffness. Its torque grows with the angle between proxy and
/// device up to half a radian, and stays as large beyond.
struct TurnSpring {
  static constexpr double kLargest = 0.5;  // [rad]

  TurnSpring(const Quat& proxy, const Quat& device) : away(turnBetween(proxy, device)), angle(away.norm()) {}

  double energy() const {
    return angle <= kLargest ? 0.5 * angle * angle : kLargest * (angle - 0.5 * kLargest);
  }
  /// Torque over angle.
  double slope() const { return angle <= kLargest ? 1.0 : kLargest / angle; }
  /// Torque on the proxy.
  Vec3 torque() const { return slope() * away; }

  Vec3 away;     ///< turn from proxy to device [rad]
  double angle;  ///< its length [rad]
};

}  // namespace haptic_cloth
