/// The solver thread: steps without pause, never ahead of wall time.
#pragma once

#include "haptic_cloth/simulation.h"
#include "haptics/probe_tracker.h"
#include "ros/node_options.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

class SolverLoop {
 public:
  /// @throws InputError if the scene is not valid
  SolverLoop(const NodeOptions& options, SharedState& shared);

  /// Runs until shared.stop.
  void run();

 private:
  void resetWhenAsked();
  void copyFrameWhenWanted();
  void waitUntilDue();
  void takeDevice();
  void publishSnapshot();
  void record(const StepReport& report);

  double time_step_;      ///< [s]
  double probe_timeout_;  ///< [s]
  SharedState& shared_;
  Simulation simulation_;
  ProbeTracker tracker_;

  double due_ = -1.0;         ///< start of the next step on the steady clock [s]; < 0: now
  double last_start_ = -1.0;  ///< of a step [s]; < 0: none since start or pause
  double wall_per_step_;      ///< smoothed, at least time_step_ [s]
  bool probe_present_ = false;
  DeviceSample device_;  ///< of the step in hand
  std::uint64_t resets_seen_ = 0;

  SolverStats window_;
  double window_start_ = -1.0, window_start_time_ = 0.0, window_iterations_ = 0.0;
  DisplayFrame frame_;
};

}  // namespace haptic_cloth
