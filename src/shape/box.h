/// Box with its sides along the axes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shape/shape.h"

namespace haptic_cloth {
namespace shapes {

struct Box {
  static constexpr const char* kName = "box";
  static constexpr bool kHasCorners = true;
  static std::vector<std::string> dimensions() { return {"size"}; }
  static double halfWidth(const Obstacle& box) { return 0.5 * box.size.minCoeff(); }
  static double extent(const Obstacle& box) { return 0.5 * box.size.norm(); }
  static double faceCurvature(const Obstacle&) { return 0.0; }
  static double edgeDistance(const SolidLanes& box, const Vec3& point) {
    std::array<double, 3> off{};  // from the planes of the faces
    for (int c = 0; c < 3; ++c) off[c] = std::abs(point[c]) - box.half_size[c];
    double nearest = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
      const double beyond_end = std::max(off[c], 0.0);
      nearest = std::min(nearest, std::hypot(off[(c + 1) % 3], off[(c + 2) % 3], beyond_end));
    }
    return nearest;
  }
  static std::vector<DrawnPart> drawing(const Obstacle& box) {
    return {{DrawnPart::kCube, Vec3::Zero(), box.size}};
  }
};

}  // namespace shapes

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

static HAPTIC_CLOTH_INLINE DistanceLanes localDistance(shapes::Box, const SolidLanes& solid,
                                                       const Lanes3& p) {
  const double round = solid.edge_radius;
  const double half[] = {solid.half_size[0] - round, solid.half_size[1] - round, solid.half_size[2] - round};
  const Lanes one = all(1.0), zero{};
  const Lanes3 sign{ifLess(p.x, zero, -one, one), ifLess(p.y, zero, -one, one), ifLess(p.z, zero, -one, one)};
  const Lanes3 q{sign.x * p.x - half[0], sign.y * p.y - half[1], sign.z * p.z - half[2]};
  const Lanes3 out{larger(q.x, zero), larger(q.y, zero), larger(q.z, zero)};
  const Lanes d = squareRoot(dot(out, out)), depth = larger(q.x, larger(q.y, q.z));
  const Lanes inverse = ifPositive(d, 1.0 / d, zero);
  // Inside, the normal points through the nearest side, the first of several.
  const Lanes by_x = ifLess(q.x, depth, zero, one), by_y = ifLess(q.y, depth, zero, one - by_x);
  return {ifPositive(d, d, depth) - round,
          {sign.x * ifPositive(d, out.x * inverse, by_x), sign.y * ifPositive(d, out.y * inverse, by_y),
           sign.z * ifPositive(d, out.z * inverse, one - by_x - by_y)}};
}

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
