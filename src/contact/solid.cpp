#include "contact/solid.h"

#include <algorithm>

#include "shape/shapes.h"
#include "simd/kernels.h"

namespace haptic_cloth {

Solid::Solid(const Obstacle& obstacle, double edge_radius)
    : shape_(obstacle.shape),
      half_size_(0.5 * obstacle.size),
      radius_(obstacle.radius),
      half_length_(0.5 * obstacle.length),
      half_width_(haptic_cloth::halfWidth(obstacle)),
      extent_(haptic_cloth::extent(obstacle)),
      face_curvature_(haptic_cloth::faceCurvature(obstacle)),
      edge_radius_(std::min(edge_radius, half_width_)),
      friction_(obstacle.friction),
      has_corners_(haptic_cloth::hasCorners(obstacle.shape)),
      position_(obstacle.pose.position),
      rotation_(obstacle.pose.orientation.toRotationMatrix()) {}

Solid::Solid(const ProbeOptions& probe) : Solid(solidOf(probe)) {}

Vec3 Solid::swing(const Vec3& turn) const {
  if (shape_ == Shape::Sphere) return Vec3::Zero();
  if (shape_ == Shape::Box || shape_ == Shape::Plane) return turn;
  const Vec3 axis = rotation_.col(2);
  return turn - axis.dot(turn) * axis;
}

Distance Solid::distance(const Vec3& point) const {
  double x[3][kPack]{}, normal[3][kPack], value[kPack];
  for (int c = 0; c < 3; ++c) x[c][0] = point[c];
  kernels().solidDistances(lanes(), 1, {x[0], x[1], x[2]}, value, {normal[0], normal[1], normal[2]});
  return {value[0], Vec3(normal[0][0], normal[1][0], normal[2][0])};
}

double Solid::edgeDistance(const Vec3& point) const {
  return haptic_cloth::edgeDistance(lanes(), rotation_.transpose() * (point - position_));
}

double Solid::cornerDistance(const Vec3& point) const {
  return ((rotation_.transpose() * (point - position_)).cwiseAbs() - half_size_).norm();
}

SolidLanes Solid::lanes() const {
  SolidLanes lanes{shape_, {}, radius_, half_length_, edge_radius_, {}, {}};
  for (int c = 0; c < 3; ++c) {
    lanes.half_size[c] = half_size_[c];
    lanes.position[c] = position_[c];
    for (int k = 0; k < 3; ++k) lanes.rotation[3 * c + k] = rotation_(c, k);
  }
  return lanes;
}

}  // namespace haptic_cloth
