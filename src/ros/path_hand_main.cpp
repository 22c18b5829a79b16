/// A hand that does what the scene says: every probe of the node with a path follows it, and grasps in its
/// times. Time starts when the node has taken the first pose of each.
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>

#include "haptic_cloth/error.h"
#include "ros/conversions.h"
#include "ros/node_options.h"
#include "ros/steady_clock.h"
#include "ros/topics.h"

namespace {

namespace topics = haptic_cloth::topics;

/// Poses sent before time starts: the node must know each probe before it can grasp [s].
constexpr double kLead = 1.0;

struct PathOptions {
  std::string node = "haptic_cloth";  ///< whose probes these are; its parameters say which
  double rate = 1000.0;               ///< poses a second [Hz]
};

PathOptions readPathOptions(haptic_cloth::ParameterGroup group) {
  PathOptions options;
  group.read("node", options.node);
  group.read("rate", options.rate, false);
  group.rejectRest();
  return options;
}

/// One probe on its path.
class PathProbe {
 public:
  PathProbe(const haptic_cloth::NodeOptions& options, std::size_t number, ros::NodeHandle& node)
      : frame_id_(options.frame_id),
        probe_(options.scene.probes[number]),
        device_(options.probes[number].device),
        pose_(node.advertise<geometry_msgs::PoseStamped>(topics::ofProbe(probe_.name, topics::kPose),
                                                         topics::kPoseQueue)),
        grasp_(node.advertise<std_msgs::Bool>(topics::ofProbe(probe_.name, topics::kGrasp),
                                              topics::kGraspQueue)) {}

  /// @param time on the path [s]
  void step(double time) {
    geometry_msgs::PoseStamped message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = frame_id_;
    message.pose = haptic_cloth::toPose(positionForDriver(device_, pathPosition(probe_.path, time)),
                                        orientationForDriver(device_, probe_.orientation));
    pose_.publish(message);
    std_msgs::Bool closed;
    closed.data = std::any_of(probe_.grasp.begin(), probe_.grasp.end(),
                              [&](const auto& times) { return times[0] <= time && time < times[1]; });
    if (closed.data != closed_) grasp_.publish(closed);
    closed_ = closed.data;
  }

  bool isHeard() const { return pose_.getNumSubscribers() > 0; }

 private:
  std::string frame_id_;
  haptic_cloth::ProbeOptions probe_;
  haptic_cloth::DeviceOptions device_;
  ros::Publisher pose_, grasp_;
  bool closed_ = false;
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "path_hand");
  ros::NodeHandle node, private_node("~");
  XmlRpc::XmlRpcValue own, theirs;
  private_node.getParam(private_node.getNamespace(), own);
  const PathOptions path =
      readPathOptions(haptic_cloth::ParameterGroup(own, private_node.getNamespace() + " (parameters)"));
  const std::string served = node.resolveName(path.node);
  node.getParam(served, theirs);
  const haptic_cloth::NodeOptions options = haptic_cloth::parseNodeOptions(theirs, served + " (parameters)");

  std::deque<PathProbe> probes;
  for (std::size_t k = 0; k < options.scene.probes.size(); ++k) {
    if (!options.scene.probes[k].path.empty()) probes.emplace_back(options, k, node);
  }
  const double period = 1.0 / path.rate;
  double time = -kLead, due = haptic_cloth::steadyNow();
  while (ros::ok()) {
    haptic_cloth::sleepUntil(due += period);
    const bool heard =
        std::all_of(probes.begin(), probes.end(), [](const PathProbe& probe) { return probe.isHeard(); });
    if (heard) time += period;
    for (PathProbe& probe : probes) probe.step(time);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const haptic_cloth::InputError& error) {
    std::fprintf(stderr, "path_hand: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "path_hand: %s\n", error.what());
    return 1;
  }
}
