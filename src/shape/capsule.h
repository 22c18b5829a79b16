/// Capsule: points at most a radius from a line along z.
#pragma once

#include <limits>

#include "shape/sphere.h"

namespace haptic_cloth {
namespace shapes {

struct Capsule {
  static constexpr const char* kName = "capsule";
  static constexpr bool kHasCorners = false;
  static std::vector<std::string> dimensions() { return {"radius", "length"}; }
  static double halfWidth(const Obstacle& capsule) { return capsule.radius; }
  static double extent(const Obstacle& capsule) { return capsule.radius + 0.5 * capsule.length; }
  static double faceCurvature(const Obstacle&) { return std::numeric_limits<double>::infinity(); }
  static double edgeDistance(const SolidLanes&, const Vec3&) {
    return std::numeric_limits<double>::infinity();
  }
  static std::vector<DrawnPart> drawing(const Obstacle& capsule) {
    const double diameter = 2.0 * capsule.radius;
    const Vec3 ball = Vec3::Constant(diameter), end = 0.5 * capsule.length * Vec3::UnitZ();
    return {{DrawnPart::kCylinder, Vec3::Zero(), Vec3(diameter, diameter, capsule.length)},
            {DrawnPart::kSphere, -end, ball},
            {DrawnPart::kSphere, end, ball}};
  }
};

}  // namespace shapes

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(shapes::Capsule, const SolidLanes& solid,
                                                       const Lanes3& p) {
  const Lanes along = smaller(larger(p.z, all(-solid.half_length)), all(solid.half_length));
  return distanceFromPoint({p.x, p.y, p.z - along}, solid.radius);
}

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
