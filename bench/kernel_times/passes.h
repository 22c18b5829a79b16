/// The passes of an iteration, with their flops and bytes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cloth_case.h"

namespace haptic_cloth {

/// One pass over the whole mesh. Flops: an addition, multiplication, division or square root counts
/// one, a fused operation two; comparisons, selections and what is hoisted out of a loop count
/// nothing. Bytes: the least memory that a pass reads and writes, each array once, however often it
/// is gathered from.
struct Pass {
  std::string name;
  std::string part;  ///< part of an iteration: value, along, vectors, fit; step: once per step
  double flops;      ///< negative: not counted
  double bytes;
  std::function<double()> run;
  /// Pairs of a square root and a division, which take much longer than other flops.
  double roots = 0.0;
};

/// All passes except those of the minimizer itself.
std::vector<Pass> passesOf(ClothCase& cloth);

/// Flops and bytes of the minimizer itself in one iteration.
double vectorFlops(int unknowns);
double vectorBytes(int unknowns);

}  // namespace haptic_cloth
