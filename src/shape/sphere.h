/// Sphere around the origin.
#pragma once

#include <limits>

#include "shape/shape.h"

namespace haptic_cloth {
namespace shapes {

struct Sphere {
  static constexpr const char* kName = "sphere";
  static constexpr bool kHasCorners = false;
  static std::vector<std::string> dimensions() { return {"radius"}; }
  static double halfWidth(const Obstacle& sphere) { return sphere.radius; }
  static double extent(const Obstacle& sphere) { return sphere.radius; }
  static double faceCurvature(const Obstacle&) { return std::numeric_limits<double>::infinity(); }
  static double edgeDistance(const SolidLanes&, const Vec3&) {
    return std::numeric_limits<double>::infinity();
  }
  static std::vector<DrawnPart> drawing(const Obstacle& sphere) {
    return {{DrawnPart::kSphere, Vec3::Zero(), Vec3::Constant(2.0 * sphere.radius)}};
  }
};

}  // namespace shapes

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes distanceFromPoint(const Lanes3& offset, double radius) {
  const Lanes d = squareRoot(dot(offset, offset));
  const Lanes inverse = ifPositive(d, 1.0 / d, Lanes{});
  Lanes3 normal = inverse * offset;
  normal.z = ifPositive(d, normal.z, all(1.0));
  return {d - radius, normal};
}

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(shapes::Sphere, const SolidLanes& solid,
                                                       const Lanes3& p) {
  return distanceFromPoint(p, solid.radius);
}

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
