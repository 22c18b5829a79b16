/// Input of a step for a probe.
#pragma once

#include "contact/proxy.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/types.h"
#include "state/archive.h"

namespace haptic_cloth {

/// State of a probe in one step.
struct ProbeStep {
  bool present = false;
  bool turns = false;                   ///< its turn is solved for; else it has that of its device
  int unknown = 0;                      ///< first of its unknowns, counted from the first of all probes
  Vec3 device = Vec3::Zero();           ///< position of the device at the end of the step [m]
  Vec3 device_velocity = Vec3::Zero();  ///< [m/s]
  Vec3 proxy = Vec3::Zero();            ///< position of the proxy at the start of the step [m]
  Quat device_orientation = Quat::Identity();  ///< at the end of the step
  Quat aim = Quat::Identity();                 ///< orientation to which the coupling turns the proxy
  Vec3 aim_turn = Vec3::Zero();                ///< turn of the aim in the step [rad]
  Vec3 aim_velocity = Vec3::Zero();            ///< its angular velocity, filtered [rad/s]
  Quat orientation = Quat::Identity();         ///< of the proxy at the start of the step

  /// Numbers of its unknowns: a position, and perhaps a turn.
  int unknowns() const { return turns ? 6 : 3; }

  void serialize(Archive& archive) {
    archive("present", present);
    archive("device", device);
    archive("device_velocity", device_velocity);
    archive("proxy", proxy);
    archive("device_orientation", device_orientation);
    archive("orientation", orientation);
    archive("aim_velocity", aim_velocity);
  }
};

/// The coupling resists turns as if its spring and damper were spread over the probe and the hand that guides
/// it: their mean square distance from the axis [m²].
inline double turnRadiusSquared(const ProbeOptions& probe) {
  constexpr double kHand = 0.03;  // half the width of a hand [m]
  return kHand * kHand + probe.length * probe.length / 12.0;
}

}  // namespace haptic_cloth
