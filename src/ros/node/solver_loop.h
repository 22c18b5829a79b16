/// The solver thread: steps without pause, never ahead of wall time.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "haptics/solver_probe.h"
#include "haptics/step_pace.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

class SolverLoop {
 public:
  /// @throws InputError if the scene is not valid
  SolverLoop(const NodeOptions& options, SharedState& shared);

  /// Runs until shared.stop.
  void run();

  // For SolverTasks, between two steps.

  const Simulation& simulation() const { return simulation_; }
  /// The state with the options that are asked for, also while gains are still on their way to
  /// them: a node that starts with these parameters can load it.
  std::string saveState();
  /// Goes on from a state that was saved with the options that are asked for here.
  /// @throws InputError where the state does not fit; all is as it was then
  void loadState(const std::string& state, const std::string& origin);

 private:
  void resetWhenAsked();
  void startAnew();
  void takeOptions();
  void skipRamps();
  void copyFrameWhenWanted();
  void waitUntilDue();
  void moveObstacles();
  void record(const StepReport& report);

  double time_step_;  ///< [s]
  SharedState& shared_;
  LiveReader live_;
  Simulation simulation_;
  std::vector<SolverProbe> probes_;
  std::vector<std::uint64_t> targets_seen_;  ///< of each obstacle
  bool gains_move_ = false;

  double due_ = -1.0;  ///< start of the next step on the steady clock [s]; < 0: now
  StepPace pace_;
  std::uint64_t resets_seen_ = 0;

  SolverStats window_;
  double window_start_ = -1.0, window_start_time_ = 0.0, window_iterations_ = 0.0;
  DisplayFrame frame_;
};

}  // namespace haptic_cloth
