/// Twist of one cell: E = ½ · 2 B_t κ_xy² A, κ_xy = n · (x₁₁ - x₁₀ - x₀₁ + x₀₀)/(l_x l_y), with n
/// held over a step. Triples along warp and weft do not resist a saddle w = α x y; this term adds
/// the rest of the bending rigidity on the bias.
#pragma once

#include <array>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

struct TwistResult {
  double energy;    ///< [J]
  double gradient;  ///< dE/d(n · saddle) [N]
};

/// Saddle vector x₁₁ - x₁₀ - x₀₁ + x₀₀. @param x corners 00, 10, 01, 11
inline Vec3 saddle(const std::array<Vec3, 4>& x) { return x[3] - x[1] - x[2] + x[0]; }

/// Second derivative d²E/d(n · saddle)² [N/m]. @param rigidity B_t [N·m]  @param area l_x l_y [m²]
inline double twistStiffness(double rigidity, double area) { return 2.0 * rigidity / area; }

inline TwistResult evaluateTwist(const std::array<Vec3, 4>& x, const Vec3& normal, double rigidity,
                                 double area) {
  const double height = normal.dot(saddle(x)), stiffness = twistStiffness(rigidity, area);
  return {0.5 * stiffness * height * height, stiffness * height};
}

}  // namespace haptic_cloth
