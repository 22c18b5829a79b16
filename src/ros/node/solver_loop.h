/// The solver thread: takes steps without pause, as StepPacer plans them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "haptic_cloth/step_pacer.h"
#include "ros/node/obstacle_motion.h"
#include "ros/node/record_writer.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

class SolverLoop {
 public:
  /// @param recording from openRecording(); null: nothing is recorded
  /// @throws InputError if the scene is not valid
  SolverLoop(const NodeOptions& options, SharedState& shared, RecordFile recording = nullptr);

  /// Runs until `shared.stop`.
  void run();

  // Used by SolverTasks between two steps.

  /// Puts the cloth back to the start of the scene.
  void reset();
  const Simulation& simulation() const { return simulation_; }
  /// State with the requested options, even while gains are still on their ramps. So a node that
  /// starts with these parameters can load it.
  std::string saveState();
  /// Continues from a state saved with the options that are now requested.
  /// @throws InputError if the state does not fit; then nothing has changed
  void loadState(const std::string& state, const std::string& origin);

 private:
  void startAgain();
  void takeOptions();
  void skipRamps();
  void copyFrameWhenWanted();
  void moveObstacles(double length);
  void record(const StepReport& report);
  void endWindow();
  void writeStats();
  double forceError(std::size_t probe) const;

  SharedState& shared_;
  LiveReader live_;
  Simulation simulation_;
  std::vector<std::uint64_t> targets_seen_;  ///< number of the last target of each obstacle
  std::vector<ObstacleMotion> motions_;      ///< of each obstacle

  std::vector<ProbeSettings> probes_;  ///< as they were asked for
  StepPacer pacer_;
  std::optional<RecordWriter> recorder_;  ///< set if a recording was asked for

  SolverStats window_;
  double window_start_ = -1.0, window_start_time_ = 0.0, window_start_slipped_ = 0.0,
         window_iterations_ = 0.0;
  FailedSteps failed_;
  StepReport last_;  ///< of this cloth
  DisplayFrame frame_;
};

}  // namespace haptic_cloth
