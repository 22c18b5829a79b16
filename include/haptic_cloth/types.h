/// Small types shared by the whole library. SI units; right-handed frame, z up (REP-103).
#pragma once

#include <Eigen/Geometry>

namespace haptic_cloth {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// Position [m] and orientation (unit quaternion) of a body in the world frame.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// Thread directions of a woven cloth: warp runs along grid index i (x), weft along j (y).
enum Direction { kWarp = 0, kWeft = 1 };

}  // namespace haptic_cloth
