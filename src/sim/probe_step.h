/// Input of a step for a probe.
#pragma once

#include <vector>

#include "haptic_cloth/types.h"
#include "state/archive.h"

namespace haptic_cloth {

/// State of a probe in one step.
struct ProbeStep {
  bool present = false;
  int unknown = 0;                      ///< index among the present probes
  Vec3 device = Vec3::Zero();           ///< position of the device at the end of the step [m]
  Vec3 device_velocity = Vec3::Zero();  ///< [m/s]
  Vec3 proxy = Vec3::Zero();            ///< position of the proxy at the start of the step [m]

  void serialize(Archive& archive) {
    archive("present", present);
    archive("device", device);
    archive("device_velocity", device_velocity);
    archive("proxy", proxy);
  }
};

using Proxies = std::vector<Vec3>;  ///< position or displacement for each probe of the scene [m]

}  // namespace haptic_cloth
