/// Exact intersections, by CGAL.
#pragma once

#include <array>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

using Segment = std::array<Vec3, 2>;
using Triangle = std::array<Vec3, 3>;

/// Tells whether three points lie on a line.
bool isCollapsed(const Triangle& triangle);

/// Tells whether a closed segment and a closed triangle have a point in common.
/// @pre the triangle has not collapsed
bool doIntersect(const Segment& segment, const Triangle& triangle);

/// The same for two triangles.
bool doIntersect(const Triangle& a, const Triangle& b);

}  // namespace haptic_cloth
