/// Input of a step for a probe.
#pragma once

#include "contact/proxy.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/types.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Input of a step for a probe, and where its proxy starts.
struct ProbeStep {
  bool present = false;
  bool turns = false;                   ///< the coupling turns it, so its turn is solved for
  int unknown = 0;                      ///< first of its unknowns, counted from the first of all probes
  Vec3 device = Vec3::Zero();           ///< position of the device at the end of the step [m]
  Vec3 device_velocity = Vec3::Zero();  ///< [m/s]
  Quat device_orientation = Quat::Identity();  ///< at the end of the step
  Vec3 device_turn = Vec3::Zero();             ///< turn of the device in the step [rad]
  Vec3 proxy = Vec3::Zero();                   ///< position of the proxy at the start of the step [m]
  Quat orientation = Quat::Identity();         ///< of the proxy at the start of the step

  /// Number of its unknowns: a position, and perhaps a turn.
  int unknowns() const { return turns ? 6 : 3; }

  void serialize(Archive& archive) {
    archive("present", present);
    archive("device", device);
    archive("device_velocity", device_velocity);
    archive("device_orientation", device_orientation);
    archive("proxy", proxy);
    archive("orientation", orientation);
  }
};

/// The coupling resists turns as if its spring and damper were spread over the probe and the hand that guides
/// it: their mean square distance from the axis [m²].
inline double turnRadiusSquared(const ProbeOptions& probe) {
  constexpr double kHand = 0.03;  // half the width of a hand [m]
  return kHand * kHand + probe.length * probe.length / 12.0;
}

/// Spring of a coupling against turns, over its stiffness. Its torque grows with the angle between proxy and
/// device up to half a radian, and stays as large beyond.
struct TurnSpring {
  static constexpr double kLargest = 0.5;  // [rad]

  explicit TurnSpring(const Quat& proxy, const Quat& device)
      : away(turnBetween(proxy, device)), angle(away.norm()) {}

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
