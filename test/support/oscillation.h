/// What a sampled swing was like.
#pragma once

#include <vector>

namespace haptic_cloth {

/// A swing about a rest position: z = ρ e^{iφ} a step.
struct Oscillation {
  double phase;   ///< φ [rad a step]
  double energy;  ///< kept over a period, ρ^{4π/φ} [-]
};

/// By least squares of x_{n+1} - 2ρ cos φ x_n + ρ² x_{n-1} = const over steps `stride` apart.
/// @param first sample that counts
Oscillation fitOscillation(const std::vector<double>& x, int first, int stride);

}  // namespace haptic_cloth
