/// Half space below z = 0. It has no centre and no width.
#pragma once

#include <limits>

#include "shape/shape.h"

namespace haptic_cloth {
namespace shapes {

struct Plane {
  static constexpr const char* kName = "plane";
  static constexpr bool kHasCorners = false;
  static std::vector<std::string> dimensions() { return {}; }
  static double halfWidth(const Obstacle&) { return std::numeric_limits<double>::infinity(); }
  static double extent(const Obstacle&) { return 0.0; }
  static double faceCurvature(const Obstacle&) { return std::numeric_limits<double>::infinity(); }
  static double edgeDistance(const SolidLanes&, const Vec3&) {
    return std::numeric_limits<double>::infinity();
  }
  static std::vector<DrawnPart> drawing(const Obstacle&) {
    constexpr double kSide = 2.0, kDepth = 0.002;  // of the drawn part [m]
    return {{DrawnPart::kCube, -0.5 * kDepth * Vec3::UnitZ(), Vec3(kSide, kSide, kDepth)}};
  }
};

}  // namespace shapes

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(shapes::Plane, const SolidLanes&, const Lanes3& p) {
  return {p.z, {Lanes{}, Lanes{}, all(1.0)}};
}

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
