#include "contact/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/solid_lanes.h"

namespace haptic_cloth {
namespace {

Distance fromPoint(const Vec3& offset, double radius) {
  const double d = offset.norm();
  return {d - radius, d > 0.0 ? Vec3(offset / d) : Vec3::UnitZ()};
}

Distance box(const Vec3& p, const Vec3& half) {
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

Distance cylinder(const Vec3& p, double radius, double half_length) {
  const double r = std::hypot(p.x(), p.y());
  const Vec3 radial = r > 0.0 ? Vec3(p.x() / r, p.y() / r, 0.0) : Vec3::UnitX();
  const Vec3 axial(0.0, 0.0, p.z() < 0 ? -1.0 : 1.0);
  const double side = r - radius, cap = std::abs(p.z()) - half_length;
  if (side > 0.0 && cap > 0.0) {
    const double d = std::hypot(side, cap);
    return {d, (side * radial + cap * axial) / d};
  }
  return side > cap ? Distance{side, radial} : Distance{cap, axial};
}

}  // namespace

Solid::Solid(const Obstacle& obstacle)
    : shape_(obstacle.shape),
      half_size_(0.5 * obstacle.size),
      radius_(obstacle.radius),
      half_length_(0.5 * obstacle.length),
      friction_(obstacle.friction),
      position_(obstacle.pose.position),
      rotation_(obstacle.pose.orientation.toRotationMatrix()) {}

Solid::Solid(const ProbeOptions& probe)
    : shape_(probe.length > 0.0 ? Shape::Capsule : Shape::Sphere),
      half_size_(Vec3::Zero()),
      radius_(probe.radius),
      half_length_(0.5 * probe.length),
      friction_(probe.friction),
      position_(Vec3::Zero()),
      rotation_(Eigen::Matrix3d::Identity()) {}

double Solid::halfWidth() const {
  switch (shape_) {
    case Shape::Box:
      return half_size_.minCoeff();
    case Shape::Cylinder:
      return std::min(radius_, half_length_);
    case Shape::Sphere:
    case Shape::Capsule:
      return radius_;
    case Shape::Plane:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

double Solid::extent() const {
  switch (shape_) {
    case Shape::Box:
      return half_size_.norm();
    case Shape::Cylinder:
      return std::hypot(radius_, half_length_);
    case Shape::Sphere:
    case Shape::Capsule:
      return radius_ + half_length_;
    case Shape::Plane:
      break;
  }
  return 0.0;
}

Distance Solid::distance(const Vec3& point) const {
  if (shape_ == Shape::Sphere) return fromPoint(point - position_, radius_);
  Distance d = local(rotation_.transpose() * (point - position_));
  d.normal = rotation_ * d.normal;
  return d;
}

SolidLanes Solid::lanes() const {
  SolidLanes lanes{shape_, {}, radius_, half_length_, {}, {}};
  for (int c = 0; c < 3; ++c) {
    lanes.half_size[c] = half_size_[c];
    lanes.position[c] = position_[c];
    for (int k = 0; k < 3; ++k) lanes.rotation[3 * c + k] = rotation_(c, k);
  }
  return lanes;
}

Distance Solid::local(const Vec3& p) const {
  switch (shape_) {
    case Shape::Box:
      return box(p, half_size_);
    case Shape::Sphere:
      return fromPoint(p, radius_);
    case Shape::Cylinder:
      return cylinder(p, radius_, half_length_);
    case Shape::Capsule:
      return fromPoint(p - Vec3(0.0, 0.0, std::clamp(p.z(), -half_length_, half_length_)), radius_);
    case Shape::Plane:
      break;
  }
  return {p.z(), Vec3::UnitZ()};
}

}  // namespace haptic_cloth
