#include "ros/node/obstacle_motion.h"

#include <algorithm>
#include <cmath>

#include "contact/proxy.h"

namespace haptic_cloth {
namespace {

/// The rotation vector of a turn that is nearest to another one, whole turns apart.
Vec3 unwrapped(const Vec3& turn, const Vec3& other) {
  const double angle = turn.norm(), whole = 2.0 * EIGEN_PI;
  if (angle == 0.0) return turn;
  const Vec3 axis = turn / angle;
  return (angle + whole * std::round((other.dot(axis) - angle) / whole)) * axis;
}

}  // namespace

void ObstacleMotion::aim(const Pose& target, double time) {
  constexpr double kMargin = 1.25;  // over the interval of poses, which trembles
  // An interval that shrinks by this share of the time leaves an even motion at most 1/(1 - share) times as
  // fast while the obstacle catches up.
  constexpr double kShrinks = 0.2;
  const double passed = time - aimed_;
  if (isOnItsWay()) turn_ += turnBetween(target_.orientation, target.orientation);
  target_ = target;
  interval_ = std::min(kLongest, std::max(kMargin * passed, interval_ - kShrinks * passed));
  aimed_ = time;
  remaining_ = interval_;
}

Pose ObstacleMotion::advance(const Pose& now, double length) {
  const double share = length < remaining_ ? length / remaining_ : 1.0;
  remaining_ = std::max(0.0, remaining_ - length);
  if (share == 1.0) {
    turn_.setZero();
    return target_;
  }
  constexpr double kRounding = 1e-12;  // [rad]
  const Vec3 position = now.position + share * (target_.position - now.position);
  const Vec3 turn = unwrapped(turnBetween(now.orientation, target_.orientation), turn_);
  turn_ = (1.0 - share) * turn;
  // An obstacle that stands still must not tremble: the cloth on it would never rest.
  if (turn.norm() < kRounding) return {position, target_.orientation};
  const Quat part(Eigen::AngleAxisd(share * turn.norm(), turn.stableNormalized()));
  return {position, part * now.orientation};
}

}  // namespace haptic_cloth
