#include "contact/proxy.h"

#include <cmath>

#include "mesh/block.h"

namespace haptic_cloth {

Quat rotationBy(const Vec3& turn) {
  const double angle = turn.norm();
  if (!(angle > 0.0)) return Quat::Identity();
  return Quat(Eigen::AngleAxisd(angle, turn / angle));
}

Vec3 turnBetween(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

Mat3 spinPerTurn(const Vec3& turn) {
  const double angle = turn.norm();
  const Mat3 cross = crossMatrix(turn);
  // Below this angle the series' next terms are lost in rounding.
  const bool small = angle < 1e-4;
  const double a = small ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double b = small ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Mat3::Identity() + a * cross + b * cross * cross;
}

}  // namespace haptic_cloth
