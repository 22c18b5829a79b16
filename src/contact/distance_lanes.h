/// Signed distances from solids, in SIMD lanes; the formulas are those of shape.cpp.
#pragma once

#include "contact/solid_lanes.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

struct DistanceLanes {
  Lanes value;
  Lanes3 normal;
};

static HAPTIC_CLOTH_INLINE DistanceLanes fromPoint(const Lanes3& offset, double radius) {
  const Lanes d = squareRoot(dot(offset, offset));
  const Lanes inverse = ifPositive(d, 1.0 / d, Lanes{});
  Lanes3 normal = inverse * offset;
  normal.z = ifPositive(d, normal.z, all(1.0));
  return {d - radius, normal};
}

static HAPTIC_CLOTH_INLINE DistanceLanes boxDistance(const Lanes3& p, const double* half) {
  const Lanes one = all(1.0), zero{};
  const Lanes3 sign{ifLess(p.x, zero, -one, one), ifLess(p.y, zero, -one, one), ifLess(p.z, zero, -one, one)};
  const Lanes3 q{sign.x * p.x - half[0], sign.y * p.y - half[1], sign.z * p.z - half[2]};
  const Lanes3 out{larger(q.x, zero), larger(q.y, zero), larger(q.z, zero)};
  const Lanes d = squareRoot(dot(out, out)), depth = larger(q.x, larger(q.y, q.z));
  const Lanes inverse = ifPositive(d, 1.0 / d, zero);
  // Inside, the normal points through the nearest side, the first of several.
  const Lanes by_x = ifLess(q.x, depth, zero, one), by_y = ifLess(q.y, depth, zero, one - by_x);
  return {ifPositive(d, d, depth),
          {sign.x * ifPositive(d, out.x * inverse, by_x), sign.y * ifPositive(d, out.y * inverse, by_y),
           sign.z * ifPositive(d, out.z * inverse, one - by_x - by_y)}};
}

static HAPTIC_CLOTH_INLINE DistanceLanes cylinderDistance(const Lanes3& p, double radius,
                                                          double half_length) {
  const Lanes one = all(1.0), zero{};
  const Lanes r = squareRoot(p.x * p.x + p.y * p.y), inverse_r = ifPositive(r, 1.0 / r, zero);
  const Lanes rx = ifPositive(r, p.x * inverse_r, one), ry = p.y * inverse_r;
  const Lanes up = ifLess(p.z, zero, -one, one), side = r - radius, cap = up * p.z - half_length;
  const Lanes edge = smaller(side, cap);  // if positive, the nearest point is on the edge of a cap
  const Lanes d = squareRoot(side * side + cap * cap), inverse = ifPositive(edge, 1.0 / d, zero);
  const Lanes by_side = ifLess(cap, side, one, zero);
  const Lanes along = ifPositive(edge, side * inverse, by_side),
              across = up * ifPositive(edge, cap * inverse, one - by_side);
  return {ifPositive(edge, d, larger(side, cap)), {along * rx, along * ry, across}};
}

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(const SolidLanes& solid, const Lanes3& p) {
  switch (solid.shape) {
    case Shape::Box:
      return boxDistance(p, solid.half_size);
    case Shape::Sphere:
      return fromPoint(p, solid.radius);
    case Shape::Cylinder:
      return cylinderDistance(p, solid.radius, solid.half_length);
    case Shape::Capsule: {
      const Lanes along = smaller(larger(p.z, all(-solid.half_length)), all(solid.half_length));
      return fromPoint({p.x, p.y, p.z - along}, solid.radius);
    }
    case Shape::Plane:
      break;
  }
  return {p.z, {Lanes{}, Lanes{}, all(1.0)}};
}

static HAPTIC_CLOTH_INLINE DistanceLanes distance(const SolidLanes& solid, const Lanes3& point) {
  const Lanes3 offset{point.x - solid.position[0], point.y - solid.position[1], point.z - solid.position[2]};
  if (solid.shape == Shape::Sphere) return fromPoint(offset, solid.radius);
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
