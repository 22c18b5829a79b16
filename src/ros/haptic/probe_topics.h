/// Interface of one probe to other nodes: topics and a service.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <std_msgs/Bool.h>
#include <std_srvs/SetBool.h>

#include <string>

#include "ros/input/device_input.h"
#include "ros/input/force_input.h"

namespace haptic_cloth {

/// Callback queues, each with one thread of its own: a pose waits for no service.
struct Queues {
  ros::CallbackQueue& poses;
  ros::CallbackQueue& services;
};

class ProbeTopics {
 public:
  /// @param number of the probe in the scene
  ProbeTopics(const NodeOptions& options, std::size_t number, const tf2_ros::Buffer& transforms,
              ros::NodeHandle node, const Queues& queues, SharedState& shared);

  const std::string& name() const { return name_; }
  const InputCounters& poses() const { return input_.counters(); }
  /// Counters of the forces that an admittance device sends; nullptr for the other kind.
  const InputCounters* forces() const { return admittance_ ? &force_.counters() : nullptr; }
  const ros::Publisher& reaction() const { return reaction_; }
  const ros::Publisher& command() const { return command_; }  ///< of admittance devices alone
  const ros::Publisher& proxy() const { return proxy_; }
  /// Full name of its service.
  std::string service() const { return set_grasp_.getService(); }

 private:
  void subscribe(ros::NodeHandle& node, ros::CallbackQueue& poses);
  /// Closes or opens the grasp. @return why not; empty if all is well
  std::string grasp(bool closed);
  bool setGrasp(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);

  std::string name_;
  const std::atomic<bool>& paused_;
  SharedProbe& shared_;
  bool admittance_;
  DeviceInput input_;
  ForceInput force_;
  ros::Publisher reaction_, command_, proxy_;
  ros::Subscriber pose_subscriber_, force_subscriber_, grasp_subscriber_;
  ros::ServiceServer set_grasp_;
};

}  // namespace haptic_cloth
