/// Signed distance from the solids that the cloth can touch. All are convex, so each distance is a
/// convex function.
#pragma once

#include <cmath>

#include "haptic_cloth/scene.h"
#include "shape/solid_lanes.h"
#include "state/archive.h"

namespace haptic_cloth {

struct Distance {
  double value;  ///< negative inside [m]
  Vec3 normal;   ///< unit gradient, pointing outwards
};

/// A solid placed in the world.
class Solid {
 public:
  /// @param edge_radius by which sharp edges are rounded [m]; at most half of the smallest width is
  explicit Solid(const Obstacle& obstacle, double edge_radius = 0.0);
  explicit Solid(const ProbeOptions& probe);

  /// Distance of one point, by the kernel that computes those of many.
  Distance distance(const Vec3& point) const;

  /// The same solid without rounded edges.
  Solid sharp() const {
    Solid solid = *this;
    solid.edge_radius_ = 0.0;
    return solid;
  }

  double friction() const { return friction_; }

  void place(const Vec3& position) { position_ = position; }
  void turn(const Quat& orientation) { turn(Mat3(orientation.toRotationMatrix())); }
  void turn(const Mat3& rotation) { rotation_ = rotation; }
  const Vec3& position() const { return position_; }
  const Mat3& rotation() const { return rotation_; }

  void serialize(Archive& archive) {
    archive("position", position_);
    archive("rotation", rotation_);
  }

  /// Half of the smallest width [m]; infinite for a plane.
  double halfWidth() const { return half_width_; }

  /// Largest distance of its surface from its centre [m]; zero for a plane.
  double extent() const { return extent_; }

  /// Part of a turn that moves its surface: not that about an axis of symmetry [rad].
  Vec3 swing(const Vec3& turn) const;

  /// Curvature of the faces between its sharp edges [1/m]; infinite if it has none.
  double faceCurvature() const { return face_curvature_; }

  /// Distance of a point from the nearest sharp edge [m]; infinite if it has none.
  double edgeDistance(const Vec3& point) const;

  /// Largest curvature of its surface beside sharp edges [1/m].
  double curvature() const { return std::isfinite(face_curvature_) ? face_curvature_ : 1.0 / half_width_; }

  bool hasCorners() const { return has_corners_; }

  /// Distance of a point from the nearest corner, where three faces meet [m].  @pre hasCorners()
  double cornerDistance(const Vec3& point) const;

  /// Description for the kernels.
  SolidLanes lanes() const;

 private:
  Shape shape_;
  Vec3 half_size_;
  double radius_, half_length_, half_width_, extent_, face_curvature_, edge_radius_, friction_;
  bool has_corners_;
  Vec3 position_;
  Mat3 rotation_;
};

}  // namespace haptic_cloth
