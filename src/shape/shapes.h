/// Shapes of solids beside their distances: names, dimensions and drawings.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/scene.h"
#include "shape/shape.h"

namespace haptic_cloth {

/// Names in scene files.
std::vector<std::pair<std::string, Shape>> shapeNames();

/// Keys of an obstacle that only some shapes have.
std::vector<std::string> dimensionsOf(Shape shape);

/// Half of the smallest width [m]; infinite for a plane.
double halfWidth(const Obstacle& solid);

/// Largest distance of the surface from the centre [m]; zero for a plane.
double extent(const Obstacle& solid);

/// Curvature of the faces between the sharp edges [1/m]; infinite without such edges.
double faceCurvature(const Obstacle& solid);

/// Distance of a point of the solid's frame from the nearest sharp edge [m]; infinite without such edges.
double edgeDistance(const SolidLanes& solid, const Vec3& point);

/// Tells whether it has corners, those of its half size along the axes.
bool hasCorners(Shape shape);

/// Parts of its picture, in the solid's frame.
std::vector<DrawnPart> drawing(const Obstacle& solid);

/// The solid of a probe, at the origin.
Obstacle solidOf(const ProbeOptions& probe);

}  // namespace haptic_cloth
