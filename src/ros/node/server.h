/// Server of the node and the nodelet: topics, services and threads around one simulation.
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <optional>

#include "ros/node/record_writer.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Input of the node.
struct NodeInput {
  NodeOptions options;
  RecordFile recording;  ///< null: nothing is recorded
};

/// Reads the private parameters and the files they name, and opens the recording.
/// @param called_off asked while a file system does not answer; true cancels
/// @return the input, or nothing if cancelled  @throws InputError for bad parameters
std::optional<NodeInput> readParameters(
    const ros::NodeHandle& private_node, const std::function<bool()>& called_off = [] { return false; });

/// Runs the simulation, the haptic loop and the display in threads of their own, and serves their topics and
/// services.
class HapticClothServer {
 public:
  /// Starts all threads. @param input from readParameters()
  HapticClothServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node, NodeInput input);

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
