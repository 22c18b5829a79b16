/// The node and the nodelet: topics, services and threads around one simulation.
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <optional>

#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Reads the private parameters and the files that they name.
/// @param called_off is asked while a file system does not answer: whether to wait no longer
/// @return the options, unless that was called off  @throws InputError for bad parameters
std::optional<NodeOptions> readParameters(
    const ros::NodeHandle& private_node, const std::function<bool()>& called_off = [] { return false; });

class HapticClothServer {
 public:
  /// Starts all threads. @param options of readParameters()
  HapticClothServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                    const NodeOptions& options);

  /// Stops as stop() does.
  ~HapticClothServer();

  /// Rethrows what ended a thread, if something did.
  void check();

  /// Ends the threads; the last that goes out is force zero, and it has been given time to go.
  void stop();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptic_cloth
