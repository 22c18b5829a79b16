#include "ros/options/reconfigure_server.h"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/this_node.h>

#include <algorithm>

#include "haptic_cloth/error.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/options/reconfigure_messages.h"

namespace haptic_cloth {

ReconfigureServer::ReconfigureServer(const NodeOptions& options, ros::NodeHandle private_node,
                                     SharedState& shared)
    : origin_(private_node.getNamespace() + " (live)"),
      node_(private_node),
      shared_(shared),
      live_(firstOptions(options)),
      offered_(offeredOptions(options)) {
  descriptions_ =
      node_.advertise<dynamic_reconfigure::ConfigDescription>(topics::kOptionDescriptions, 1, true);
  updates_ = node_.advertise<dynamic_reconfigure::Config>(topics::kOptionUpdates, 1, true);
  descriptions_.publish(toDescription(offered_, options));
  updates_.publish(toConfig(offered_, options));
  service_ = node_.advertiseService(topics::kSetOptions, &ReconfigureServer::set, this);
}

bool ReconfigureServer::set(Request& request, Response& response) {
  try {
    NodeOptions now = *live_.options;
    if (!shared_.recording) now.record.clear();  // a recording that has ended forbids nothing
    takeOver(changed(now, toValues(request.config), origin_));
    report_.refused_last = false;
  } catch (const InputError& error) {
    ROS_WARN_STREAM("refused, nothing changed: " << error.what());
    ++report_.refused;
    report_.refused_last = true;
    report_.refusal = error.what();
  }
  shared_.live_report.write(report_);
  response.config = toConfig(offered_, *live_.options);
  updates_.publish(response.config);
  return true;
}

void ReconfigureServer::takeOver(const NodeOptions& options) {
  const std::shared_ptr<const NodeOptions> before = live_.options;
  live_ = nextOptions(live_, options, steadyNow());
  for (Mailbox<LiveOptions>* mailbox : {&shared_.live_for_haptics, &shared_.live_for_solver,
                                        &shared_.live_for_poses, &shared_.live_for_display}) {
    mailbox->write(live_);
  }
  ++report_.taken;
  const LiveValues old_values = liveValues(*before);
  for (const auto& [name, value] : liveValues(options)) {
    if (value != old_values.at(name)) keep(name, value);
  }
  const std::vector<std::string> known = deviceWarnings(*before);
  for (const std::string& warning : deviceWarnings(options)) {
    if (std::find(known.begin(), known.end(), warning) == known.end()) ROS_WARN_STREAM(warning);
  }
}

/// Stores a value among the private parameters, where a restarted node finds it. Does not wait for
/// a lost master.
void ReconfigureServer::keep(const std::string& name, const LiveValue& value) const {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = node_.resolveName(name);
  std::visit([&request](const auto& v) { request[2] = v; }, value);
  if (ros::master::execute("setParam", request, response, payload, false)) {
    ROS_INFO_STREAM(name << " = " << request[2]);
  } else {
    ROS_WARN_STREAM(name << " = " << request[2] << " is in force, but no master keeps it as a parameter");
  }
}

}  // namespace haptic_cloth
