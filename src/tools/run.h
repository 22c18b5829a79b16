/// One run of a scene from its start to its stop rule, with everything worth writing down.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "haptic_cloth/step_pacer.h"

namespace haptic_cloth {

/// A row of steps.csv.
struct StepRecord {
  StepReport report;
  EnergyReport energy;
  double wall_time = 0.0;  ///< of this step [s]
};

/// A row of a probe's file.
struct ProbeRecord {
  double time = 0.0;  ///< [s]
  ProbeReport probe;
};

/// How a run kept the clock. Means are over simulated time.
struct PaceTotals {
  double elapsed = 0.0;    ///< wall time from the first step to the end of the last [s]
  double slipped = 0.0;    ///< simulated time given up [s]
  double mean_rung = 0.0;  ///< 0: the quality that the scene asks for
  int worst_rung = 0;
  double longest_step = 0.0;  ///< [s]
};

/// Sums over a run, kept also when no rows are.
struct RunTotals {
  int steps = 0;
  long iterations = 0;
  long evaluations = 0;
  int failed_steps = 0, converged_steps = 0;
  double max_residual = 0.0;           ///< [|gravity|]
  int min_active = 0, max_active = 0;  ///< particles; those at hand if there was no step
  double mean_active = 0.0;            ///< particles
  long refined = 0, coarsened = 0;     ///< cells split, groups of four merged
  double max_penetration = 0.0;        ///< [m]
  double max_obstacle_lag = 0.0;       ///< of an obstacle behind its path; not of a replay [m]
  /// Smallest StepReport::min_self_gap [m].
  double min_self_gap = std::numeric_limits<double>::infinity();
  double start_time = 0.0;         ///< simulated time before the first step: not 0 where a run is resumed [s]
  double wall_time = 0.0;          ///< of all steps [s]
  bool at_rest = false;            ///< ended by stop.rest_speed, not by stop.time
  std::optional<PaceTotals> pace;  ///< set if the run kept the clock
  StepReport last;
};

/// Rows that a run keeps. The energies of a step take time, which a run that keeps the clock lacks.
enum class Rows { None, Probes, All };

struct RunRecord {
  RunTotals totals;
  std::vector<StepRecord> steps;
  std::vector<std::vector<ProbeRecord>> probes;  ///< of each probe of the scene
};

/// The fastest particle has to stay below stop.rest_speed for this long before a run ends early: cloth that
/// is about to fall, or that turns round at the end of a swing, is slow for a moment only [s].
constexpr double kRestDuration = 0.1;

/// Called after each step.
using StepCallback = std::function<void(const Simulation&, const RunTotals&)>;

/// Prepares the next step and sets its length. @return false: there is none
using NextStep = std::function<bool(Simulation&, int& length)>;

/// Runs the simulation step by step, as long as there is a next one.
RunRecord runSteps(Simulation& simulation, Rows rows, const NextStep& next, const StepCallback& after_step);

/// Runs the simulation from its present time to its scene's stop rule. Devices and obstacles follow their
/// paths: at each step they stand where the path is at the end of the step; devices have the step's mean
/// velocity.
RunRecord runScene(Simulation& simulation, Rows rows, const StepCallback& after_step);

/// The same in wall time: StepPacer plans length and quality of the steps, as in the node.
RunRecord runInRealTime(Simulation& simulation, Rows rows, const StepCallback& after_step);

/// Every position and energy is finite.
bool isFinite(const Simulation& simulation);

}  // namespace haptic_cloth
