/// Types for the headers of the shapes, and the recipe of one.
///
/// A shape `Cone` is a header like the others of this folder, the line `SHAPE(Cone)` in
/// shape_table.h and the enumerator in haptic_cloth/scene.h. Its header holds
///
///   * struct shapes::Cone with
///       kName           name in scene files
///       dimensions()    keys of an obstacle that this shape has; all are required
///       halfWidth()     half of the smallest width [m]
///       extent()        largest distance of its surface from its centre [m]
///       faceCurvature() curvature of the faces between its sharp edges [1/m]; infinite if it has none
///       edgeDistance()  distance of a point of the local frame from its nearest sharp edge [m]; infinite
///                       without such edges
///       kHasCorners     whether it has corners: those of a box of size `size`
///       drawing()       what a display draws
///   * for the kernels localDistance(): signed distance and outer unit normal at points p of the
///     local frame [m]. The solid is convex, so its distance is a convex function. Sharp edges are rounded by
///     the edge radius: the distance from the solid that is smaller by it on all sides, minus it.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "shape/solid_lanes.h"

#ifdef HAPTIC_CLOTH_PATH
#include "simd/lanes.h"
#endif

namespace haptic_cloth {

/// Part of the drawing of a solid: a unit body, stretched and moved.
struct DrawnPart {
  enum Body { kCube, kSphere, kCylinder } body;  ///< of diameter and height 1 m
  Vec3 offset;                                   ///< of its centre, in the solid's frame [m]
  Vec3 size;                                     ///< [m]
};

#ifdef HAPTIC_CLOTH_PATH
namespace HAPTIC_CLOTH_PATH {

struct DistanceLanes {
  Lanes value;  ///< negative inside [m]
  Lanes3 normal;
};

}  // namespace HAPTIC_CLOTH_PATH
#endif
}  // namespace haptic_cloth
