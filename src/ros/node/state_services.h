/// Services that save and load the state of the cloth.
#pragma once

#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <functional>

#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// Files are read and written on separate threads (runFileWork), which may wait for a file system
/// without delaying anything else. The solver only copies its state.
class StateServices {
 public:
  /// @param for_save, for_load private node handles with a callback queue each, so that saving and
  /// loading do not wait for each other
  StateServices(ros::NodeHandle for_save, ros::NodeHandle for_load, const Scene& scene, SharedState& shared);

 private:
  bool save(SaveState::Request& request, SaveState::Response& response);
  bool load(LoadState::Request& request, LoadState::Response& response);
  void run(const SolverTasks::Work& work) const;
  void runFiles(const std::function<void()>& work) const;

  SharedState& shared_;
  std::uint64_t largest_;  ///< size limit of a state of this scene [bytes]
  ros::ServiceServer save_service_, load_service_;
};

}  // namespace haptic_cloth
