/// Ladder of the qualities that a late solver gives up, in order.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/options.h"

namespace haptic_cloth {

/// Limit of the iterations of a solver that is late but keeps its forces: nearly all its steps need fewer.
constexpr int kManyIterations = 200;

/// Options of one rung of the ladder.
struct Quality {
  SolverOptions solver;
  AdaptOptions adapt;
  int longest_step = 1;  ///< longest step, in units of solver.time_step
  std::string given_up;  ///< for display; empty: nothing
};

/// Makes the ladder: the first rung has the scene's own options and steps of one time_step, and each
/// other costs less than the one before. No option is finer than the scene's.
/// @param longest_step limit of the steps of all rungs, in units of solver.time_step; at least 1
std::vector<Quality> qualityLadder(const SolverOptions& solver, const AdaptOptions& adapt, int longest_step);

}  // namespace haptic_cloth
