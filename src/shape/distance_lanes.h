/// Signed distances from solids, in SIMD lanes.
#pragma once

#include "shape/shape_table.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(const SolidLanes& solid, const Lanes3& p) {
  switch (solid.shape) {
#define HAPTIC_CLOTH_CASE(name) \
  case Shape::name:             \
    return localDistance(shapes::name(), solid, p);
    HAPTIC_CLOTH_SHAPES(HAPTIC_CLOTH_CASE)
#undef HAPTIC_CLOTH_CASE
  }
  __builtin_unreachable();  // spares a branch in every call: the table has all shapes
}

static HAPTIC_CLOTH_INLINE DistanceLanes distance(const SolidLanes& solid, const Lanes3& point) {
  const Lanes3 offset{point.x - solid.position[0], point.y - solid.position[1], point.z - solid.position[2]};
  if (solid.shape == Shape::Sphere) return localDistance(shapes::Sphere(), solid, offset);
  const double* r = solid.rotation;
  const Lanes3 p{r[0] * offset.x + r[3] * offset.y + r[6] * offset.z,
                 r[1] * offset.x + r[4] * offset.y + r[7] * offset.z,
                 r[2] * offset.x + r[5] * offset.y + r[8] * offset.z};
  const DistanceLanes d = localDistance(solid, p);
  const Lanes3& n = d.normal;
  return {d.value,
          {r[0] * n.x + r[1] * n.y + r[2] * n.z, r[3] * n.x + r[4] * n.y + r[5] * n.z,
           r[6] * n.x + r[7] * n.y + r[8] * n.z}};
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
