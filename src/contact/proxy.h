/// Where the proxy of a probe is in a step, and how it turns.
#pragma once

#include <cmath>
#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Place of a proxy, or how fast it changes along a direction. A turn is a rotation vector: its axis times
/// its angle.
struct Proxy {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 turn = Vec3::Zero();      ///< since the step began; of a direction: angular [rad]
};

using Proxies = std::vector<Proxy>;  ///< one for each probe of the scene

/// Rotation by a rotation vector [rad].
inline Quat rotationBy(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, turn / angle)) : Quat::Identity();
}

/// Rotation vector of the shorter way from one orientation to another [rad].
inline Vec3 turnBetween(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

/// Angular displacement per change of the rotation vector at `turn` [rad]: the left Jacobian of rotations.
inline Mat3 spinPerTurn(const Vec3& turn) {
  const double angle = turn.norm();
  const Mat3 cross = crossMatrix(turn);
  // Below this angle the series' next terms are lost in rounding.
  const bool small = angle < 1e-4;
  const double a = small ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double b = small ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Mat3::Identity() + a * cross + b * cross * cross;
}

}  // namespace haptic_cloth
