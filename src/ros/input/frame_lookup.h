/// Looks up frames of poses in tf.
#pragma once

#include <ros/time.h>

#include <optional>
#include <string>

#include "haptic_cloth/types.h"

namespace tf2_ros {
class Buffer;
}

namespace haptic_cloth {

class FrameLookup {
 public:
  /// @param frame_id the cloth's frame
  FrameLookup(const std::string& frame_id, const tf2_ros::Buffer& transforms);

  /// A frame in the cloth's frame.
  struct Found : Pose {
    ros::Time stamp;  ///< of its newest transform; zero if it does not change
  };

  /// Newest pose of `frame` in the cloth's frame. An empty name means the cloth's frame. Empty if
  /// there is no finite transform.
  std::optional<Found> find(const std::string& frame) const;

  const std::string& clothFrame() const { return frame_id_; }

 private:
  std::string frame_id_;
  const tf2_ros::Buffer& transforms_;
};

}  // namespace haptic_cloth
