/// Topic of a named obstacle.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <string>

#include "ros/input/obstacle_input.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"

namespace haptic_cloth {

class ObstacleTopics {
 public:
  ObstacleTopics(const Obstacle& obstacle, const FrameLookup& frames, ros::NodeHandle& node,
                 ros::CallbackQueue& queue, Mailbox<ObstacleTarget>& shared)
      : name_(obstacle.name), input_(obstacle, frames, shared) {
    ros::SubscribeOptions pose = ros::SubscribeOptions::create<geometry_msgs::PoseStamped>(
        topics::obstaclePose(name_), topics::kPoseQueue,
        [this](const geometry_msgs::PoseStamped::ConstPtr& message) { input_.accept(*message, steadyNow()); },
        ros::VoidConstPtr(), &queue);
    subscriber_ = node.subscribe(pose);
  }

  const std::string& name() const { return name_; }
  const DropCounters& counters() const { return input_.counters(); }

 private:
  std::string name_;
  ObstacleInput input_;
  ros::Subscriber subscriber_;
};

}  // namespace haptic_cloth
