/// Server of the node and the nodelet: topics, services and threads around one simulation.
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <optional>

#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Reads the private parameters and the files they name.
/// @param called_off asked while a file system does not answer; true cancels
/// @return the options, or nothing if cancelled  @throws InputError for bad parameters
std::optional<NodeOptions> readParameters(
    const ros::NodeHandle& private_node, const std::function<bool()>& called_off = [] { return false; });

class HapticClothServer {
 public:
  /// Starts all threads. @param options from readParameters()
  HapticClothServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                    const NodeOptions& options);

  /// Calls stop().
  ~HapticClothServer();

  /// Rethrows the exception that ended a thread, if there is one.
  void check();

  /// Ends the threads. The last wrench sent is zero, and it is given time to leave the process.
  void stop();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptic_cloth
