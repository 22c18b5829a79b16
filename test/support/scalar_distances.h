/// Distance of one point at a time: the formulas that the kernels are compared with.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact/solid.h"

namespace haptic_cloth {

inline Distance scalarDistanceFromPoint(const Vec3& offset, double radius) {
  const double d = offset.norm();
  return {d - radius, d > 0.0 ? Vec3(offset / d) : Vec3(Vec3::UnitZ())};
}

inline Distance scalarBox(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  const Vec3 sign(p.x() < 0 ? -1.0 : 1.0, p.y() < 0 ? -1.0 : 1.0, p.z() < 0 ? -1.0 : 1.0);
  const Vec3 outside = q.cwiseMax(0.0);
  const double d = outside.norm();
  if (d > 0.0) return {d, Vec3(outside.cwiseProduct(sign) / d)};
  int nearest = 0;
  const double depth = q.maxCoeff(&nearest);
  Vec3 normal = Vec3::Zero();
  normal[nearest] = sign[nearest];
  return {depth, normal};
}

inline Distance scalarCylinder(const Vec3& p, double radius, double half_length) {
  const double r = std::hypot(p.x(), p.y());
  const Vec3 radial = r > 0.0 ? Vec3(p.x() / r, p.y() / r, 0.0) : Vec3(Vec3::UnitX());
  const Vec3 axial(0.0, 0.0, p.z() < 0 ? -1.0 : 1.0);
  const double side = r - radius, cap = std::abs(p.z()) - half_length;
  if (side > 0.0 && cap > 0.0) {
    const double d = std::hypot(side, cap);
    return {d, (side * radial + cap * axial) / d};
  }
  return side > cap ? Distance{side, radial} : Distance{cap, axial};
}

/// Distance from a solid that is smaller by the edge radius on all sides, minus that radius.
inline Distance rounded(const Distance& smaller, double edge_radius) {
  return {smaller.value - edge_radius, smaller.normal};
}

/// Distance in the solid's frame.
inline Distance scalarLocalDistance(const Obstacle& solid, const Vec3& p, double edge_radius) {
  const double half_length = 0.5 * solid.length;
  switch (solid.shape) {
    case Shape::Box:
      return rounded(scalarBox(p, 0.5 * solid.size - Vec3::Constant(edge_radius)), edge_radius);
    case Shape::Sphere:
      return scalarDistanceFromPoint(p, solid.radius);
    case Shape::Cylinder:
      return rounded(scalarCylinder(p, solid.radius - edge_radius, half_length - edge_radius), edge_radius);
    case Shape::Capsule:
      return scalarDistanceFromPoint(p - Vec3(0.0, 0.0, std::clamp(p.z(), -half_length, half_length)),
                                     solid.radius);
    case Shape::Plane:
      return {p.z(), Vec3::UnitZ()};
  }
  throw std::logic_error("this shape has no scalar formula");
}

inline Distance scalarDistance(const Obstacle& solid, const Vec3& point, double edge_radius = 0.0) {
  const Mat3 rotation = solid.pose.orientation.toRotationMatrix();
  const Vec3 local = rotation.transpose() * (point - solid.pose.position);
  const Distance d = scalarLocalDistance(solid, local, edge_radius);
  return {d.value, rotation * d.normal};
}

}  // namespace haptic_cloth
