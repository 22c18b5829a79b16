/// What a closed probe holds.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// A node that moves with a probe's proxy.
struct HeldNode {
  int node, probe;
  Vec3 offset;  ///< from the proxy [m]
};

}  // namespace haptic_cloth
