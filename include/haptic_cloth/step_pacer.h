/// Keeps the simulated time of a simulation at wall time.
#pragma once

#include <memory>
#include <string>

#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// How a solver follows the clock.
struct PaceOptions {
  bool keep_clock = true;  ///< a late solver gives up quality; false: simulated time falls behind
  /// Longest step of a late solver, finite and > 0 [s]. At least one time step is made.
  double max_time_step = 0.004;
};

/// Quality that the solver gives up to keep the clock.
struct QualityReport {
  int rung = 0;              ///< 0: the quality that the scene asks for
  std::string given_up;      ///< in words; empty: nothing
  double step_length = 0.0;  ///< of the last step [s]
  double slipped = 0.0;      ///< simulated time given up since the start [s]
};

/// Plans each step of a simulation from the wall times at which steps start and end. A late solver
/// takes longer steps and lowers their quality; what affects the force least is given up first.
/// When there is time to spare, quality returns to what the scene asks for. No step starts before
/// simulated time is due.
///
///     sleep until pacer.due(now);
///     const int length = pacer.begin(simulation, now);
///     session.beforeStep(simulation, now, length);
///     const StepReport step = simulation.step(length);
///     session.afterStep(simulation, now);
///     pacer.end(step, now);
///
/// All functions belong to the solver's thread. `now` is in seconds on a steady clock, >= 0. The simulation
/// keeps the quality of the last step: call restoreQuality() before a pacer goes, and change options by the
/// pacer alone.
class StepPacer {
 public:
  /// @param simulation is not kept; its options are the quality asked for
  /// @throws InputError if an option is not valid
  explicit StepPacer(const Simulation& simulation, const PaceOptions& options = PaceOptions());
  ~StepPacer();
  StepPacer(StepPacer&&) noexcept;
  StepPacer& operator=(StepPacer&&) noexcept;

  /// Changes the quality asked for, from the next step on. @pre solver, adapt and air_damping are valid for
  /// the simulation's setOptions()
  /// @throws InputError if one of `options` is not valid; then nothing has changed
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping,
                  const PaceOptions& options);

  /// Wall time before which the next step must not start [s].
  double due(double now) const;

  /// Starts a step: gives the simulation the options of the rung in use.
  /// @return length of the step, in time steps of the scene
  int begin(Simulation& simulation, double now);

  /// The step that was begun has ended. @param step what the simulation said of it
  void end(const StepReport& step, double now);

  /// Forgets the lag, as after a pause: the next step is due at once.
  void restart();

  /// Gives the simulation the options asked for. Call it before a state is saved or loaded, because a
  /// state holds the options of its scene. The next step sets those of its rung again.
  void restoreQuality(Simulation& simulation);

  QualityReport quality() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptic_cloth
