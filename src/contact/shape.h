/// Signed distance of the solids the cloth can touch. All are convex, so each distance is a convex function.
#pragma once

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

struct Distance {
  double value;  ///< negative inside [m]
  Vec3 normal;   ///< unit gradient: the way out
};

struct SolidLanes;

/// A solid placed in the world.
class Solid {
 public:
  explicit Solid(const Obstacle& obstacle);

  Distance distance(const Vec3& point) const;

  double friction() const { return friction_; }

  /// For loops over lanes.
  SolidLanes lanes() const;

 private:
  Distance local(const Vec3& point) const;

  Shape shape_;
  Vec3 half_size_;
  double radius_, half_length_, friction_;
  Vec3 position_;
  Eigen::Matrix3d rotation_;
};

}  // namespace haptic_cloth
