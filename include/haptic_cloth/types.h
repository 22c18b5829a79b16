/// Small types shared by the whole library. SI units; right-handed frame, z up (REP-103).
#pragma once

#include <Eigen/Geometry>

namespace haptic_cloth {

using Vec3 = Eigen::Vector3d;     ///< a vector in space
using Mat3 = Eigen::Matrix3d;     ///< a linear map of such vectors
using Quat = Eigen::Quaterniond;  ///< a rotation, of norm 1

/// Position [m] and orientation (unit quaternion) of a body in the world frame.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// A haptic device at the end of a step, in the world frame.
struct DeviceState {
  Vec3 position = Vec3::Zero();         ///< [m]
  Vec3 velocity = Vec3::Zero();         ///< [m/s]
  Quat orientation = Quat::Identity();  ///< matters where the probe is a capsule
  double elapsed = 0.0;  ///< by the hand's clock since the state before; a time step at least [s]
};

/// No hand is faster [m/s]; and so far may a device be from where it seems, as poses come late: what a hand
/// at 2 m/s moves in 50 ms [m].
constexpr double kFastestHand = 10.0, kLatePose = 0.1;

/// Whether a device is elsewhere without having moved there: its driver or tracker lost it, or began anew.
/// @param way [m]  @param elapsed meanwhile [s]
inline bool isJump(double way, double elapsed) { return way > kFastestHand * elapsed + kLatePose; }

/// Thread directions of a woven cloth: warp runs along grid index i (x), weft along j (y).
enum Direction { kWarp = 0, kWeft = 1 };

}  // namespace haptic_cloth
