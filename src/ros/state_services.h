/// The services that save and load the state of the cloth.
#pragma once

#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/node_handle.h>

#include "ros/shared_state.h"

namespace haptic_cloth {

/// Files are read and written by the thread of the services; the solver only copies its state.
class StateServices {
 public:
  /// @param private_node with the callback queue of the services
  StateServices(ros::NodeHandle& private_node, SharedState& shared);

 private:
  bool save(SaveState::Request& request, SaveState::Response& response);
  bool load(LoadState::Request& request, LoadState::Response& response);
  void run(const SolverTasks::Work& work) const;

  SharedState& shared_;
  ros::ServiceServer save_service_, load_service_;
};

}  // namespace haptic_cloth
