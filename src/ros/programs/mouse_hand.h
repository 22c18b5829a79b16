/// A hand without a device: a probe that follows a marker which is dragged in rviz.
#pragma once

#include <visualization_msgs/InteractiveMarker.h>

#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// A marker is dragged by jumps, one for each frame of the picture; a hand moves smoothly. The first-order
/// lag makes of a jump a motion that dies away. Pure arithmetic.
class SmoothedPose {
 public:
  /// @param time_constant of the lag [s]
  SmoothedPose(const Pose& start, double time_constant) : pose_(start), time_constant_(time_constant) {}

  /// The pose `dt` [s] later on its way to the target.
  const Pose& step(const Pose& target, double dt);

 private:
  Pose pose_;
  double time_constant_;
};

/// Where a probe waits for the mouse: at the start of its path, or over the cloth; `number` of `count` probes
/// in a row.
Pose waitingPose(const Scene& scene, std::size_t number);

/// A handle for a probe: its shape a little larger, to be dragged in the plane of the screen, with an arrow
/// for each axis and, for a capsule, a ring.
visualization_msgs::InteractiveMarker probeHandle(const ProbeOptions& probe, const Pose& pose,
                                                  const std::string& frame_id);

}  // namespace haptic_cloth
