/// Scenes that together use every part of a simulation's state, and the entries of a saved state.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// Events of a run, to check what a case exercises.
struct Exercised {
  int refined = 0, coarsened = 0;  ///< number of cells
  /// Steps that were skipped; steps in which some particles slept and others did not.
  int idle = 0, asleep = 0;
  /// Steps in which a probe was in contact; steps in which one held cloth.
  int touched = 0, held = 0;
  /// Steps in which a probe was present, inside the cloth, and touched nothing.
  int ignored = 0;
  int most_awake = 0;  ///< largest number of awake particles
  int moved = 0;       ///< steps in which an obstacle moved
  int layers = 0;      ///< steps in which layers of the cloth pressed on each other
};

/// Run whose inputs depend only on the number of the step.
struct StateCase {
  std::string name;
  Scene scene;
  std::function<void(Simulation&, int step)> drive;
  int steps;
  std::vector<int> saves;  ///< steps after which the state is saved
  /// Tells whether the run exercised what the case is for.
  std::function<bool(const Exercised&)> exercises;
  /// Length of a step in units of the scene's time_step; empty: 1.
  std::function<int(int step)> length = {};
};

std::vector<StateCase> stateCases();

/// Hash of the bits of everything that can be queried.
std::uint64_t readings(const Simulation& simulation);

/// Hash that also covers the report of a step, except its times.
std::uint64_t readings(const Simulation& simulation, const StepReport& report);

/// Makes one step of a case. @param exercised updated if given @return readings after the step
std::uint64_t advance(const StateCase& run, Simulation& simulation, int step, Exercised* exercised = nullptr);

/// Entry of a saved state, see docs/reference/states.md.
struct StateEntry {
  std::string name;
  char type;
  std::string bytes;
};

std::vector<StateEntry> stateEntries(const std::string& sealed);

/// Makes a valid state from entries, whatever they contain.
std::string sealState(const std::vector<StateEntry>& entries);

}  // namespace haptic_cloth
