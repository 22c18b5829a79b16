/// Live change of options with the tools of dynamic_reconfigure.
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "ros/node/shared_state.h"
#include "ros/options/live_options.h"

namespace haptic_cloth {

/// Serves ~set_parameters and publishes the current values on ~parameter_updates and the
/// descriptions on ~parameter_descriptions. A request is accepted or refused as a whole. If it is
/// refused, the response holds the old values; the log and the diagnostics give the reason.
/// Accepted values are also stored among the private parameters.
///
/// The server of dynamic_reconfigure itself is not used: it would clamp a large value to a limit in
/// a .cfg file instead of refusing it, and it cannot know the names of the probes.
class ReconfigureServer {
 public:
  /// @param private_node its queue belongs to the thread that answers
  ReconfigureServer(const NodeOptions& options, ros::NodeHandle private_node, SharedState& shared);

 private:
  using Request = dynamic_reconfigure::Reconfigure::Request;
  using Response = dynamic_reconfigure::Reconfigure::Response;
  bool set(Request& request, Response& response);
  void takeOver(const NodeOptions& options);
  void keep(const std::string& name, const LiveValue& value) const;

  std::string origin_;  ///< source in error messages
  ros::NodeHandle node_;
  SharedState& shared_;
  LiveOptions live_;
  std::vector<LiveOption> offered_;
  LiveReport report_;
  ros::Publisher updates_, descriptions_;
  ros::ServiceServer service_;
};

}  // namespace haptic_cloth
