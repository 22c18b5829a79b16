/// Scenes that together use every part of a simulation's state, and the entries of a saved one.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// What a run went through.
struct Exercised {
  int refined = 0, coarsened = 0;  ///< cells
  int idle = 0, asleep = 0;        ///< steps left out; steps in which some slept and some did not
  int touched = 0, held = 0;       ///< steps in which a probe was in contact; in which one held cloth
  int ignored = 0;                 ///< steps in which a probe was there, in the cloth, and touched nothing
  int most_awake = 0;              ///< particles
  int moved = 0;                   ///< steps in which an obstacle changed its pose
};

/// A run of which each step's inputs depend on nothing but the step's number.
struct StateCase {
  std::string name;
  Scene scene;
  std::function<void(Simulation&, int step)> drive;
  int steps;
  std::vector<int> saves;                           ///< after so many steps it is saved
  std::function<bool(const Exercised&)> exercises;  ///< what the case is there for
};

std::vector<StateCase> stateCases();

/// Hash over the bits of all that can be asked of a simulation.
std::uint64_t readings(const Simulation& simulation);

/// The same, and all of what a step says of itself but the time it took.
std::uint64_t readings(const Simulation& simulation, const StepReport& report);

/// One step of a case. @param exercised added to, if given @return readings after it
std::uint64_t advance(const StateCase& run, Simulation& simulation, int step, Exercised* exercised = nullptr);

/// An entry of a saved state, see docs/reference/states.md.
struct StateEntry {
  std::string name;
  char type;
  std::string bytes;
};

std::vector<StateEntry> stateEntries(const std::string& sealed);

/// A state of these entries, whole in all but what they say.
std::string sealState(const std::vector<StateEntry>& entries);

}  // namespace haptic_cloth
