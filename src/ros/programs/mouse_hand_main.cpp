/// A hand for users without a device: every probe of the node follows a marker that is dragged in
/// rviz. The menu of a marker (right mouse button) closes and opens the grasp.
#include <geometry_msgs/PoseStamped.h>
#include <interactive_markers/interactive_marker_server.h>
#include <interactive_markers/menu_handler.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include <deque>

#include "haptic_cloth/haptics.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/options/node_options.h"
#include "ros/programs/mouse_hand.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

using haptic_cloth::Pose;
using interactive_markers::InteractiveMarkerServer;
using interactive_markers::MenuHandler;
using Feedback = visualization_msgs::InteractiveMarkerFeedback;

/// One probe and its marker. The thread of the marker server drags it, the main thread moves it.
class MouseProbe {
 public:
  MouseProbe(const haptic_cloth::NodeOptions& options, std::size_t number, double time_constant,
             ros::NodeHandle& node, InteractiveMarkerServer& server)
      : frame_id_(options.frame_id),
        device_(options.probes[number].device),
        target_(waitingPose(options.scene, number)),
        hand_(target_, time_constant),
        server_(server) {
    const haptic_cloth::ProbeOptions& probe = options.scene.probes[number];
    namespace topics = haptic_cloth::topics;
    pose_ = node.advertise<geometry_msgs::PoseStamped>(topics::ofProbe(probe.name, topics::kPose),
                                                       topics::kPoseQueue);
    grasp_ = node.advertise<std_msgs::Bool>(topics::ofProbe(probe.name, topics::kGrasp), topics::kGraspQueue);
    dragged_.write(target_);
    server.insert(probeHandle(probe, target_, frame_id_),
                  [this](const Feedback::ConstPtr& feedback) { drag(*feedback); });
    menu_.insert("grasp", [this](const Feedback::ConstPtr&) { grasp(true); });
    menu_.insert("let go", [this](const Feedback::ConstPtr&) { grasp(false); });
    menu_.apply(server, probe.name);
  }

  void step(double dt) {
    const Pose& hand = hand_.step(dragged_.read(), dt);
    geometry_msgs::PoseStamped message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = frame_id_;
    message.pose = haptic_cloth::toPose(poseForDriver(device_, hand));
    pose_.publish(message);
  }

 private:
  void drag(const Feedback& feedback) {
    if (feedback.event_type != Feedback::POSE_UPDATE) return;
    const bool good =
        haptic_cloth::isFinite(feedback.pose) && haptic_cloth::isUnit(feedback.pose.orientation);
    if (good) dragged_.write(haptic_cloth::toPose(feedback.pose));
    server_.applyChanges();
  }

  void grasp(bool closed) {
    std_msgs::Bool message;
    message.data = closed;
    grasp_.publish(message);
  }

  std::string frame_id_;
  haptic_cloth::DeviceOptions device_;
  Pose target_;
  haptic_cloth::SmoothedPose hand_;
  haptic_cloth::Mailbox<Pose> dragged_;  ///< thread of the marker server → main thread
  InteractiveMarkerServer& server_;
  MenuHandler menu_;
  ros::Publisher pose_, grasp_;
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "mouse_hand");
  haptic_cloth::endOnSigterm();
  ros::NodeHandle node, private_node("~");
  const auto mouse = haptic_cloth::ownOptions<haptic_cloth::MouseHandOptions>(private_node);
  const std::string served = node.resolveName(mouse.node);
  const haptic_cloth::NodeOptions options = haptic_cloth::optionsOf(node, served);

  InteractiveMarkerServer server("probes", "", true);
  std::deque<MouseProbe> probes;
  for (std::size_t k = 0; k < options.scene.probes.size(); ++k) {
    probes.emplace_back(options, k, mouse.time_constant, node, server);
  }
  server.applyChanges();
  ros::AsyncSpinner spinner(1);
  spinner.start();
  const double period = 1.0 / mouse.rate, start = haptic_cloth::steadyNow();
  for (long tick = 1; ros::ok(); ++tick) {
    haptic_cloth::sleepUntil(start + static_cast<double>(tick) * period);
    for (MouseProbe& probe : probes) probe.step(period);
  }
  server.clear();
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("mouse_hand", run, argc, argv); }
