#include "ros/node/obstacle_motion.h"

#include <algorithm>

namespace haptic_cloth {

void ObstacleMotion::aim(const Pose& target, double time) {
  constexpr double kMargin = 1.25;  // over the interval of poses, which trembles
  // An interval that shrinks by this share of the time leaves an even motion at most 1/(1 - share) times as
  // fast while the obstacle catches up.
  constexpr double kShrinks = 0.2;
  const double passed = time - aimed_;
  target_ = target;
  interval_ = std::min(kLongest, std::max(kMargin * passed, interval_ - kShrinks * passed));
  aimed_ = time;
  remaining_ = interval_;
}

Pose ObstacleMotion::advance(const Pose& now, double length) {
  const double share = length < remaining_ ? length / remaining_ : 1.0;
  remaining_ = std::max(0.0, remaining_ - length);
  if (share == 1.0) return target_;
  return {now.position + share * (target_.position - now.position),
          now.orientation.slerp(share, target_.orientation)};
}

}  // namespace haptic_cloth
