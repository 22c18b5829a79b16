/// Motion of an obstacle between the poses of a topic.
#pragma once

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Moves an obstacle evenly from pose to pose. Steps are shorter than the time between two poses, so an
/// obstacle that made all of its way in one step would throw the cloth. Each way takes a little longer than
/// poses were lately apart, so that a pose that comes late finds the obstacle still on its way. The first one
/// takes long, because it may be far; the obstacle then catches up slowly. All times are simulated ones [s].
class ObstacleMotion {
 public:
  /// Aims at a new pose. @param time at which the next step starts
  void aim(const Pose& target, double time);

  /// Forgets the target and how far poses are apart.
  void stop() { *this = ObstacleMotion(); }

  /// Forgets how far poses are apart, because no steps are made for a while.
  void interrupt() { interval_ = kLongest; }

  /// Tells whether the target has not been reached.
  bool isOnItsWay() const { return remaining_ > 0.0; }

  /// Pose at the end of a step.
  /// @param now pose at its start  @param length of the step
  Pose advance(const Pose& now, double length);

 private:
  static constexpr double kLongest = 0.5;  ///< time of a way, at most [s]

  Pose target_;
  /// Rotation vector of what is left of the way, which may be several turns [rad].
  Vec3 turn_ = Vec3::Zero();
  double aimed_ = -kLongest;    ///< time of the last aim()
  double interval_ = kLongest;  ///< time of a way
  double remaining_ = 0.0;      ///< of the present way
};

}  // namespace haptic_cloth
