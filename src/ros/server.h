/// The node and the nodelet: topics, services and threads around one simulation.
#pragma once

#include <ros/node_handle.h>

#include <memory>

namespace haptic_cloth {

class HapticClothServer {
 public:
  /// Reads the private parameters and starts all threads.
  /// @throws InputError for bad parameters, with nothing started
  HapticClothServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

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
