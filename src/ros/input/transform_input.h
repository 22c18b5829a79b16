/// Subscribes to transforms of frames.
#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

namespace haptic_cloth {

/// Fills a buffer from /tf and /tf_static, on a thread of its own, and clears it when the clock is set back.
/// tf2_ros::TransformListener does the same, but a transform with a stamp near the end of ros::Time ends the
/// program.
class TransformInput {
 public:
  /// @param transforms must outlive this object
  explicit TransformInput(tf2_ros::Buffer& transforms);

 private:
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  void take(const Event& event, bool fixed);

  tf2_ros::Buffer& transforms_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::Subscriber moving_, fixed_;
  ros::Time last_;  ///< of the last message
  ros::AsyncSpinner spinner_;
};

}  // namespace haptic_cloth
