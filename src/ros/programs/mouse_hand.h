/// A hand without a device: a probe follows a marker that is dragged in rviz.
#pragma once

#include <visualization_msgs/InteractiveMarker.h>

#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// Smooths the motion of a dragged marker. A marker jumps once per picture frame, but a hand moves
/// smoothly. The first-order lag turns each jump into a motion that decays. Pure arithmetic.
class SmoothedPose {
 public:
  /// @param time_constant time constant of the lag [s]
  SmoothedPose(const Pose& start, double time_constant) : pose_(start), time_constant_(time_constant) {}

  /// Pose `dt` [s] later on the way to the target.
  const Pose& step(const Pose& target, double dt);

 private:
  Pose pose_;
  double time_constant_;
};

/// Waiting place of a probe: the start of its path, or above the cloth in a row with the other
/// probes.
Pose waitingPose(const Scene& scene, std::size_t number);

/// Handle of a probe: its shape, a little larger, to be dragged in the plane of the screen, with an
/// arrow for each axis and, for a capsule, a ring for each axis.
visualization_msgs::InteractiveMarker probeHandle(const ProbeOptions& probe, const Pose& pose,
                                                  const std::string& frame_id);

}  // namespace haptic_cloth
