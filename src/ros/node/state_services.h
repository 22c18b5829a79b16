/// The services that save and load the state of the cloth.
#pragma once

#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <functional>

#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// Files are read and written by threads that may wait for a file system without holding up
/// anything else (runFileWork); the solver only copies its state.
class StateServices {
 public:
  /// @param for_save, for_load private node handles with a callback queue each: loading that waits
  /// does not hold up saving, nor the other way round
  StateServices(ros::NodeHandle for_save, ros::NodeHandle for_load, const Scene& scene, SharedState& shared);

 private:
  bool save(SaveState::Request& request, SaveState::Response& response);
  bool load(LoadState::Request& request, LoadState::Response& response);
  void run(const SolverTasks::Work& work) const;
  void runFiles(const std::function<void()>& work) const;

  SharedState& shared_;
  std::uint64_t largest_;  ///< of all states of the scene [bytes]
  ros::ServiceServer save_service_, load_service_;
};

}  // namespace haptic_cloth
