/// Cylinder around z.
#pragma once

#include <algorithm>
#include <cmath>

#include "shape/shape.h"

namespace haptic_cloth {
namespace shapes {

struct Cylinder {
  static constexpr const char* kName = "cylinder";
  static constexpr bool kHasCorners = false;
  static std::vector<std::string> dimensions() { return {"radius", "length"}; }
  static double halfWidth(const Obstacle& cylinder) {
    return std::min(cylinder.radius, 0.5 * cylinder.length);
  }
  static double extent(const Obstacle& cylinder) {
    return std::hypot(cylinder.radius, 0.5 * cylinder.length);
  }
  static double faceCurvature(const Obstacle& cylinder) { return 1.0 / cylinder.radius; }
  static double edgeDistance(const SolidLanes& cylinder, const Vec3& point) {
    return std::hypot(point.head<2>().norm() - cylinder.radius, std::abs(point.z()) - cylinder.half_length);
  }
  static std::vector<DrawnPart> drawing(const Obstacle& cylinder) {
    const double diameter = 2.0 * cylinder.radius;
    return {{DrawnPart::kCylinder, Vec3::Zero(), Vec3(diameter, diameter, cylinder.length)}};
  }
};

}  // namespace shapes

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(shapes::Cylinder, const SolidLanes& solid,
                                                       const Lanes3& p) {
  const Lanes one = all(1.0), zero{};
  const Lanes r = squareRoot(p.x * p.x + p.y * p.y), inverse_r = ifPositive(r, 1.0 / r, zero);
  const Lanes rx = ifPositive(r, p.x * inverse_r, one), ry = p.y * inverse_r;
  const Lanes up = ifLess(p.z, zero, -one, one);
  const double round = solid.edge_radius;
  const Lanes side = r - (solid.radius - round), cap = up * p.z - (solid.half_length - round);
  const Lanes edge = smaller(side, cap);  // if positive, the nearest point is on the edge of a cap
  const Lanes d = squareRoot(side * side + cap * cap), inverse = ifPositive(edge, 1.0 / d, zero);
  const Lanes by_side = ifLess(cap, side, one, zero);
  const Lanes along = ifPositive(edge, side * inverse, by_side),
              across = up * ifPositive(edge, cap * inverse, one - by_side);
  return {ifPositive(edge, d, larger(side, cap)) - round, {along * rx, along * ry, across}};
}

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
