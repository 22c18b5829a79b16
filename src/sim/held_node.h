/// Node that a closed probe holds.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// The end of a way, or where a share of it [-] leads.
inline Vec3 partOfWay(const Vec3& start, const Vec3& end, double share) {
  return share < 1.0 ? Vec3(start + share * (end - start)) : end;
}

/// A free node that moves with the proxy of a probe, and turns with the probe. Offsets are from the proxy
/// [m].
struct HeldNode {
  int node, probe;
  Vec3 arm;     ///< offset in axes that turn with the probe
  Vec3 start;   ///< offset at the start of the step
  Vec3 end;     ///< offset where the turn of the probe leads
  Vec3 offset;  ///< offset now, on the straight way from start to end
};

}  // namespace haptic_cloth
