/// Shear of one cell: E = A ψ(γ), sin γ = û · v̂ with u, v the mean sides along warp and weft. An angle, so
/// that it adds nothing to stretch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "haptic_cloth/curve.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

struct ShearResult {
  double energy;         ///< [J]
  double force;          ///< A S(γ): dE/dγ [N·m]
  double stiffness;      ///< A S'(γ) [N·m]
  Vec3 rising, falling;  ///< dγ/dx of corner 11 (minus that of 00) and of corner 10 (minus that of 01) [1/m]
};

/// The angle γ [rad] alone. @param x corners 00, 10, 01, 11
inline double shearAngle(const std::array<Vec3, 4>& x) {
  const Vec3 u = x[3] - x[0] + x[1] - x[2], v = x[3] - x[0] - x[1] + x[2];
  const double scale = u.norm() * v.norm();
  return scale > 0.0 ? std::asin(std::clamp(u.dot(v) / scale, -1.0, 1.0)) : 0.0;
}

/// @param x corners 00, 10, 01, 11  @param area [m²]  @param shear law: angle [rad] → Curve::Point of force
/// [N/m]
template <class Law>
inline ShearResult evaluateShear(const std::array<Vec3, 4>& x, double area, const Law& shear) {
  const Vec3 rising = x[3] - x[0], falling = x[1] - x[2];
  const Vec3 u = rising + falling, v = rising - falling;  // twice the mean sides; only directions matter
  const double nu = u.norm(), nv = v.norm();
  const double scale = nu * nv;
  if (!(scale > 0.0)) return {0.0, 0.0, 0.0, Vec3::Zero(), Vec3::Zero()};
  const Vec3 uu = u / nu, vv = v / nv;
  const double sine = std::clamp(uu.dot(vv), -1.0, 1.0);
  const double cosine = std::max(std::sqrt(1.0 - sine * sine), 1e-3);  // a cell folded flat: bounded
  const Curve::Point law = shear(std::asin(sine));
  const Vec3 du = (vv - sine * uu) / (nu * cosine), dv = (uu - sine * vv) / (nv * cosine);
  return {area * law.potential, area * law.force, area * law.slope, du + dv, du - dv};
}

}  // namespace haptic_cloth
