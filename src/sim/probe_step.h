/// Input of a step for a probe.
#pragma once

#include "contact/proxy.h"
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
  Quat prescribed = Quat::Identity();          ///< the same at its end, if it is not solved for

  /// Number of its unknowns: a position, and perhaps a turn.
  int unknowns() const { return turns ? 6 : 3; }

  void serialize(Archive& archive) {
    archive("present", present);
    archive("turns", turns);
    archive("device", device);
    archive("device_velocity", device_velocity);
    archive("device_orientation", device_orientation);
    archive("proxy", proxy);
    archive("orientation", orientation);
  }
};

}  // namespace haptic_cloth
