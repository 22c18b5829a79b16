/// Analysis of a sampled oscillation.
#pragma once

#include <vector>

namespace haptic_cloth {

/// Oscillation about a rest position: factor z = ρ e^{iφ} per step.
struct Oscillation {
  double phase;   ///< φ [rad per step]
  double energy;  ///< energy kept over a period, ρ^{4π/φ} [-]
};

/// Fits x_{n+1} - 2ρ cos φ x_n + ρ² x_{n-1} = const by least squares, over steps `stride` apart.
/// @param first first sample to be used
Oscillation fitOscillation(const std::vector<double>& x, int first, int stride);

}  // namespace haptic_cloth
