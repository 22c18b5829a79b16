/// The passes of an iteration: what each does and how much of it there is to do.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cloth_case.h"

namespace haptic_cloth {

/// One pass over the whole mesh. Flops: additions, multiplications, divisions and square roots count one
/// each, fused ones two; comparisons, selections and what is hoisted out of a loop count nothing. Bytes: what
/// a pass reads and writes of memory at least, each array once however often it is gathered from.
struct Pass {
  std::string name;
  std::string part;  ///< of an iteration it belongs to: value, along, vectors, fit; step: once a step
  double flops;      ///< below zero: not counted
  double bytes;
  std::function<double()> run;
  double roots = 0.0;  ///< pairs of a square root and a division, which take far longer than other flops
};

/// All but those the minimizer does itself.
std::vector<Pass> passesOf(ClothCase& cloth);

/// Those of the minimizer itself, of one iteration.
double vectorFlops(int unknowns);
double vectorBytes(int unknowns);

}  // namespace haptic_cloth
