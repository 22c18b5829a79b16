/// Stretch of one edge: E = A ψ(ε), ε = |b - a| / l₀ - 1.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptic_cloth/curve.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

struct EdgeResult {
  double energy;  ///< [J]
  Vec3 gradient;  ///< gradient by b; by a it is the negative [N]
  Vec3 axis;      ///< unit vector a → b
  /// Stiffness of b - a along the axis and across it, positive part [N/m].
  double along, across;
};

/// @param length rest length [m]
/// @param width [m]
/// @param tensile law: strain → Curve::Point of tension [N/m]
template <class Law>
inline EdgeResult evaluateEdge(const Vec3& a, const Vec3& b, double length, double width,
                               const Law& tensile) {
  const Vec3 span = b - a;
  const double now = span.norm();
  const Vec3 axis = now > 0.0 ? Vec3(span / now) : Vec3::Zero();  // no direction, no force
  const Curve::Point law = tensile(now / length - 1.0);
  const double force = width * law.force;
  return {length * width * law.potential, force * axis, axis, width / length * law.slope,
          now > 0.0 ? std::max(force, 0.0) / now : 0.0};
}

/// Quadratic form d · H⁺ d for the relative motion d = d_b - d_a.
inline double edgeCurvature(const Vec3& axis, double along, double across, const Vec3& d) {
  const double s = axis.dot(d);
  return along * s * s + across * (d.squaredNorm() - s * s);
}

}  // namespace haptic_cloth
