#include "ros/input/transform_input.h"

#include <ros/console.h>

#include <exception>

namespace haptic_cloth {

TransformInput::TransformInput(tf2_ros::Buffer& transforms) : transforms_(transforms), spinner_(1, &queue_) {
  constexpr std::uint32_t kLength = 100;  // of the queues, as in tf2_ros
  node_.setCallbackQueue(&queue_);
  const auto subscribe = [this](const std::string& topic, bool fixed) {
    const boost::function<void(const Event&)> take = [this, fixed](const Event& event) {
      this->take(event, fixed);
    };
    return node_.subscribe<const tf2_msgs::TFMessage>(topic, kLength, take);
  };
  moving_ = subscribe("/tf", false);
  fixed_ = subscribe("/tf_static", true);
  transforms_.setUsingDedicatedThread(true);
  spinner_.start();
}

void TransformInput::take(const Event& event, bool fixed) {
  constexpr double kSeldom = 10.0;  // [s]
  const ros::Time now = ros::Time::now();
  if (now < last_) transforms_.clear();  // the clock was set back
  last_ = now;
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    try {
      transforms_.setTransform(transform, event.getPublisherName(), fixed);
    } catch (const std::exception& error) {
      ROS_WARN_STREAM_THROTTLE(kSeldom, "transform of " << transform.child_frame_id << " by "
                                                        << event.getPublisherName()
                                                        << " is dropped: " << error.what());
    }
  }
}

}  // namespace haptic_cloth
