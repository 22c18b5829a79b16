#include "ros/programs/hand_model.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace haptic_cloth {

Vec3 handTarget(const HandOptions& options, double time) {
  struct Move {
    double duration;
    Vec3 end;
  };
  const Vec3 far_end = options.press + options.slide;
  const std::array<Move, 6> moves{
      Move{options.approach_time, options.press}, Move{options.hold_time, options.press},
      Move{options.slide_time, far_end},          Move{options.hold_time, far_end},
      Move{options.lift_time, options.start},     Move{options.hold_time, options.start}};
  double period = 0.0;
  for (const Move& move : moves) period += move.duration;
  double left = std::fmod(std::max(0.0, time - options.delay), period);
  Vec3 from = options.start;
  for (const Move& move : moves) {
    if (left < move.duration) {
      // A smooth step, at rest at both ends.
      const double s = left / move.duration;
      return from + s * s * (3.0 - 2.0 * s) * (move.end - from);
    }
    left -= move.duration;
    from = move.end;
  }
  return options.start;
}

const Vec3& HandModel::step(const Vec3& target, const Vec3& reaction, double dt) {
  // m (v - v0) / dt = k (target - x0 - dt v) - d v + F, solved for v
  const Vec3 force = options_.stiffness * (target - position_) + reaction;
  const double inertia = options_.mass + dt * (options_.damping + dt * options_.stiffness);
  velocity_ = (options_.mass * velocity_ + dt * force) / inertia;
  position_ += dt * velocity_;
  return position_;
}

}  // namespace haptic_cloth
