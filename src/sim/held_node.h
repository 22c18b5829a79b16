/// Node that a closed probe holds.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// A free node that moves with the proxy of a probe and turns with it. Offsets are from the proxy [m].
struct HeldNode {
  int node, probe;
  Vec3 start;   ///< offset at the start of the step
  Vec3 offset;  ///< offset now, as the probe has turned
};

}  // namespace haptic_cloth
