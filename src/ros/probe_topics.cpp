#include "ros/probe_topics.h"

#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/message_event.h>

#include "ros/topics.h"

namespace haptic_cloth {
namespace {

/// A message and who sent it.
using PoseEvent = ros::MessageEvent<const geometry_msgs::PoseStamped>;

}  // namespace

ProbeTopics::ProbeTopics(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
                         ros::NodeHandle node, const Queues& queues, SharedState& shared)
    : name_(options.scene.probes[number].name),
      paused_(shared.paused),
      shared_(shared.probes[number]),
      input_(options, options.probes[number], transforms, shared_) {
  const auto named = [this](const char* topic) { return topics::ofProbe(name_, topic); };
  reaction_ = node.advertise<geometry_msgs::WrenchStamped>(named(topics::kReaction), topics::kReactionQueue);
  proxy_ = node.advertise<geometry_msgs::PoseStamped>(named(topics::kProxy), topics::kProxyQueue);
  ros::SubscribeOptions pose;
  pose.initByFullCallbackType<const PoseEvent&>(
      named(topics::kPose), topics::kPoseQueue,
      [this](const PoseEvent& event) { input_.accept(*event.getMessage(), event.getPublisherName()); });
  pose.callback_queue = &queues.poses;
  pose.transport_hints = ros::TransportHints().tcpNoDelay();
  pose_subscriber_ = node.subscribe(pose);
  // Beside the services, so that a pause and what follows it come in order.
  node.setCallbackQueue(&queues.services);
  grasp_subscriber_ = node.subscribe<std_msgs::Bool>(
      named(topics::kGrasp), topics::kGraspQueue, [this](const std_msgs::Bool::ConstPtr& message) {
        const std::string refused = grasp(message->data);
        if (!refused.empty()) ROS_WARN_STREAM(name_ << " does not grasp: " << refused);
      });
  set_grasp_ = node.advertiseService(named(topics::kSetGrasp), &ProbeTopics::setGrasp, this);
}

std::string ProbeTopics::grasp(bool closed) {
  // What would close by itself at the end of a pause, or when a device comes, surprises the hand.
  if (closed && paused_) return "paused";
  if (closed && !shared_.present) return "no pose";
  shared_.grasp_wanted = closed;
  return "";
}

bool ProbeTopics::setGrasp(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  const std::string refused = grasp(request.data);
  response.success = refused.empty();
  response.message = !refused.empty() ? refused : request.data ? "closed" : "open";
  return true;
}

}  // namespace haptic_cloth
