/// Bending of one triple: E = A ψ(κ), κ = n · (left (x_l - x_c) + right (x_r - x_c)). n is held
/// over a step so that E is a potential.
#pragma once

#include "haptic_cloth/curve.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

struct TripleResult {
  double energy;     ///< [J]
  double moment;     ///< A M(κ): dE/dκ [N·m²]
  double stiffness;  ///< A M'(κ) [N·m³]
};

/// @param left, right coefficients [1/m²]
/// @param area [m²]
/// @param bending law: curvature [1/m] → Curve::Point of moment [N·m/m]
template <class Law>
inline TripleResult evaluateTriple(const Vec3& l, const Vec3& c, const Vec3& r, const Vec3& normal,
                                   double left, double right, double area, const Law& bending) {
  const double curvature = normal.dot(left * (l - c) + right * (r - c));
  const Curve::Point law = bending(curvature);
  return {area * law.potential, area * law.force, area * law.slope};
}

}  // namespace haptic_cloth
