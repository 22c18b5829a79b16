/// Live change of options by the tools of dynamic_reconfigure.
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "ros/node/shared_state.h"
#include "ros/options/live_options.h"

namespace haptic_cloth {

/// Answers the service ~set_parameters and says what is in force on ~parameter_updates, what there is to
/// change on ~parameter_descriptions. A request is taken over as a whole or not at all: then the answer has
/// the old values, and log and diagnostics the reason. What was changed stands among the private parameters,
/// too.
///
/// The package's own server would cut what is too large down to a limit of its .cfg instead of refusing it,
/// and cannot know the names of probes.
class ReconfigureServer {
 public:
  /// @param private_node with the queue whose thread is to answer
  ReconfigureServer(const NodeOptions& options, ros::NodeHandle private_node, SharedState& shared);

  /// Full name of its service.
  std::string service() const { return service_.getService(); }

 private:
  using Request = dynamic_reconfigure::Reconfigure::Request;
  using Response = dynamic_reconfigure::Reconfigure::Response;
  bool set(Request& request, Response& response);
  void takeOver(const NodeOptions& options);
  void keep(const std::string& name, const LiveValue& value) const;

  std::string origin_;  ///< in messages
  ros::NodeHandle node_;
  SharedState& shared_;
  LiveOptions live_;
  std::vector<LiveOption> offered_;
  LiveReport report_;
  ros::Publisher updates_, descriptions_;
  ros::ServiceServer service_;
};

}  // namespace haptic_cloth
