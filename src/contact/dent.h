/// Cells of the cloth that are pressed unevenly, as in the dent under a probe: pure functions.
#pragma once

#include <algorithm>

namespace haptic_cloth {

constexpr double kUneven = 0.1;  ///< difference of gaps that changes the pressure over a cell [ranges]

/// Share of Simpson's rule in the weights of a cell's points: none where the pressure is even, all where it
/// is not. In between it grows, since a switch from one step to the next would shake cloth at rest. Corners
/// alone would carry up to nine times the force, since pressure grows fast with depth.
/// @param gap_difference of the corners of the cell, over the range of contact [-]
inline double shareOfSimpson(double gap_difference) {
  return std::clamp(gap_difference / kUneven - 1.0, 0.0, 1.0);
}

}  // namespace haptic_cloth
