/// Helpers shared by the kernels of twist.
#pragma once

#include "energy/packs.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

/// Second derivative of the twist energy by the height of the saddle [N/m]; zero for unused lanes.
static HAPTIC_CLOTH_INLINE Lanes twistStiffness(const PatchPack& pack, int lane, double rigidity) {
  const Lanes area = load(pack.area + lane);
  return ifPositive(area, 2.0 * rigidity / area, Lanes{});
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
