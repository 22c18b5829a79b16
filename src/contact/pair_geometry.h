/// Distances of the parts of a pair (PairPack).
#pragma once

#include <array>

#include "haptic_cloth/types.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// From the nearest point of the triangle a, b, c to p [m].
Vec3 fromTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Between the nearest points of two lines, from c-d to a-b [m].
Vec3 betweenLines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Tells whether a pair does not meet while its nodes move straight and evenly from one place to another.
/// @param nodes node and triangle, or the ends of both lines
/// @param from, to positions of all nodes [m]
/// @return false if they meet, and if they come so near that rounding decides
bool staysApartOnWay(const std::array<int, 4>& nodes, bool lines, const Field& from, const Field& to);

}  // namespace haptic_cloth
