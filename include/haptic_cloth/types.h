/// Small types shared by the whole library. SI units; right-handed frame, z up (REP-103).
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace haptic_cloth {

using Vec3 = Eigen::Vector3d;  ///< a vector in space
using Mat3 = Eigen::Matrix3d;  ///< a linear map of such vectors
/// A rotation, of norm 1.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

using Vec6 = Eigen::Matrix<double, 6, 1>;                    ///< a vector for motion, then one for turns
using Mat6 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;  ///< a linear map of such pairs

// A program compiled with -mavx or -march=native must see the same types as the library. Eigen would align
// those that it can to whole registers.
static_assert(alignof(Quat) <= 16 && alignof(Vec6) <= 16 && alignof(Mat6) <= 16, "see above");

/// Tells whether the norm of a quaternion is 1 but for rounding, as in a file.
inline bool isRotation(const Quat& quaternion) { return std::abs(quaternion.norm() - 1.0) <= 1e-3; }

inline Vec6 joined(const Vec3& motion, const Vec3& turn) { return (Vec6() << motion, turn).finished(); }

/// Position [m] and orientation (unit quaternion) of a body in the world frame.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// State of a haptic device at the end of a step, in the world frame.
struct DeviceState {
  Vec3 position = Vec3::Zero();         ///< [m]
  Vec3 velocity = Vec3::Zero();         ///< [m/s]
  Quat orientation = Quat::Identity();  ///< of a sphere it matters for friction and what it holds
  /// Time since the previous state by the hand's clock [s]; less than a time step counts as one.
  double elapsed = 0.0;
};

/// Limits of plausible device motion: the largest speed of a hand [m/s], and the distance that a
/// device may be off because poses come late [m]: 2 m/s for 50 ms.
constexpr double kFastestHand = 10.0, kLatePose = 0.1;
/// Limits of plausible turns of a device: the fastest turn of a hand [rad/s], and the angle that a device may
/// be off because poses come late [rad]: 20 rad/s for 50 ms.
constexpr double kFastestTurn = 30.0, kLateTurn = 1.0;

/// Tells whether a device is elsewhere without having moved there: its driver or tracker lost it or
/// was restarted.
/// @param distance distance between the two positions [m]
/// @param elapsed time between them [s]
inline bool isJump(double distance, double elapsed) { return distance > kFastestHand * elapsed + kLatePose; }

/// The same for the angle between two orientations [rad].
inline bool isTurnJump(double angle, double elapsed) { return angle > kFastestTurn * elapsed + kLateTurn; }

/// Thread directions of a woven cloth: warp runs along grid index i (x), weft along j (y).
enum Direction { kWarp = 0, kWeft = 1 };

}  // namespace haptic_cloth
