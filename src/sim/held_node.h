/// Node that a closed probe holds.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// A free node that moves with the proxy of a probe.
struct HeldNode {
  int node, probe;
  Vec3 offset;  ///< from the proxy [m]
};

}  // namespace haptic_cloth
