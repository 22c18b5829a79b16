#include "shape/shapes.h"

#include "shape/shape_table.h"

namespace haptic_cloth {
namespace {

/// Calls visit with the struct of a shape.
template <class Visit>
auto visitShape(Shape shape, const Visit& visit) {
  switch (shape) {
#define HAPTIC_CLOTH_CASE(name) \
  case Shape::name:             \
    return visit(shapes::name());
    HAPTIC_CLOTH_SHAPES(HAPTIC_CLOTH_CASE)
#undef HAPTIC_CLOTH_CASE
  }
  return visit(shapes::Plane());
}

}  // namespace

std::vector<std::pair<std::string, Shape>> shapeNames() {
#define HAPTIC_CLOTH_ENTRY(name) {shapes::name::kName, Shape::name},
  return {HAPTIC_CLOTH_SHAPES(HAPTIC_CLOTH_ENTRY)};
#undef HAPTIC_CLOTH_ENTRY
}

std::vector<std::string> dimensionsOf(Shape shape) {
  return visitShape(shape, [](auto kind) { return kind.dimensions(); });
}

double halfWidth(const Obstacle& solid) {
  return visitShape(solid.shape, [&](auto kind) { return kind.halfWidth(solid); });
}

double extent(const Obstacle& solid) {
  return visitShape(solid.shape, [&](auto kind) { return kind.extent(solid); });
}

double faceCurvature(const Obstacle& solid) {
  return visitShape(solid.shape, [&](auto kind) { return kind.faceCurvature(solid); });
}

double edgeDistance(const SolidLanes& solid, const Vec3& point) {
  return visitShape(solid.shape, [&](auto kind) { return kind.edgeDistance(solid, point); });
}

bool hasCorners(Shape shape) {
  return visitShape(shape, [](auto kind) { return kind.kHasCorners; });
}

std::vector<DrawnPart> drawing(const Obstacle& solid) {
  return visitShape(solid.shape, [&](auto kind) { return kind.drawing(solid); });
}

Obstacle solidOf(const ProbeOptions& probe) {
  Obstacle solid;
  solid.shape = probe.length > 0.0 ? Shape::Capsule : Shape::Sphere;
  solid.radius = probe.radius;
  solid.length = probe.length;
  solid.friction = probe.friction;
  return solid;
}

}  // namespace haptic_cloth
