#include "ros/haptic/probe_topics.h"

#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/message_event.h>

#include "haptic_cloth/error.h"
#include "ros/node/topics.h"

namespace haptic_cloth {

ProbeTopics::ProbeTopics(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
                         ros::NodeHandle node, const Queues& queues, SharedState& shared)
    : name_(options.scene.probes[number].name),
      paused_(shared.paused),
      shared_(shared.probes[number]),
      admittance_(options.probes[number].device.kind == DeviceKind::Admittance),
      input_(options, number, transforms, shared),
      force_(options, number, transforms, shared) {
  const auto named = [this](const char* topic) { return topics::ofProbe(name_, topic); };
  reaction_ = node.advertise<geometry_msgs::WrenchStamped>(named(topics::kReaction), topics::kReactionQueue);
  proxy_ = node.advertise<geometry_msgs::PoseStamped>(named(topics::kProxy), topics::kProxyQueue);
  if (admittance_)
    command_ = node.advertise<geometry_msgs::PoseStamped>(named(topics::kCommand), topics::kCommandQueue);
  subscribe(node, queues.poses);
  // Beside the services, so that a pause and what follows it come in order.
  node.setCallbackQueue(&queues.services);
  grasp_subscriber_ = node.subscribe<std_msgs::Bool>(
      named(topics::kGrasp), topics::kGraspQueue, [this](const std_msgs::Bool::ConstPtr& message) {
        const std::string refused = grasp(message->data);
        constexpr double kSeldom = 10.0;  // [s]; some senders repeat it
        if (!refused.empty()) ROS_WARN_STREAM_THROTTLE(kSeldom, name_ << " does not grasp: " << refused);
      });
  set_grasp_ = node.advertiseService(named(topics::kSetGrasp), &ProbeTopics::setGrasp, this);
  // Two nodelets of one manager would both answer the hand; the master sees one publisher.
  if (!set_grasp_)
    throw InputError(node.resolveName(named(topics::kSetGrasp)), "", "",
                     "is offered by another nodelet of this process: give one of them another namespace");
}

void ProbeTopics::subscribe(ros::NodeHandle& node, ros::CallbackQueue& poses) {
  const auto to = [&](const char* topic, int queue, auto& input, auto example) {
    using Event = ros::MessageEvent<const decltype(example)>;
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const Event&>(
        topics::ofProbe(name_, topic), queue,
        [&input](const Event& event) { input.accept(*event.getMessage(), event.getPublisherName()); });
    options.callback_queue = &poses;
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    return node.subscribe(options);
  };
  pose_subscriber_ = to(topics::kPose, topics::kPoseQueue, input_, geometry_msgs::PoseStamped());
  if (!admittance_) return;
  force_subscriber_ = to(topics::kForce, topics::kForceQueue, force_, geometry_msgs::WrenchStamped());
}

std::string ProbeTopics::grasp(bool closed) {
  // A grasp that closed by itself after a pause, or when a device comes, would surprise the hand.
  if (closed && paused_) return "paused";
  if (closed && !shared_.session().isPresent()) return admittance_ ? "no force" : "no pose";
  shared_.session().setGrasp(closed);
  return "";
}

bool ProbeTopics::setGrasp(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  const std::string refused = grasp(request.data);
  response.success = refused.empty();
  response.message = !refused.empty() ? refused : request.data ? "closed" : "open";
  return true;
}

}  // namespace haptic_cloth
