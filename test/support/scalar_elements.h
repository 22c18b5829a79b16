/// Energy of one element at a time: the formulas that the kernels are compared with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "energy/shear.h"
#include "haptic_cloth/curve.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

// ---- stretch of one edge: E = A ψ(ε), ε = |b - a| / l₀ - 1 ----

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
inline double edgeQuadraticForm(const Vec3& axis, double along, double across, const Vec3& d) {
  const double s = axis.dot(d);
  return along * s * s + across * (d.squaredNorm() - s * s);
}

// ---- bending of one triple: E = A ψ(κ), κ = n · bent(x) ----

struct TripleResult {
  double energy;     ///< [J]
  double moment;     ///< A M(κ): dE/dκ [N·m²]
  double stiffness;  ///< A M'(κ) [N·m³]
};

/// @param bent vector whose component along the normal is the curvature [1/m]
/// @param area [m²]
/// @param bending law: curvature [1/m] → Curve::Point of moment [N·m/m]
template <class Law>
inline TripleResult evaluateTriple(const Vec3& bent, const Vec3& normal, double area, const Law& bending) {
  const Curve::Point law = bending(normal.dot(bent));
  return {area * law.potential, area * law.force, area * law.slope};
}

// ---- shear of one cell: E = A ψ(γ) ----

struct ShearResult : ShearSlope {
  double energy;     ///< [J]
  double force;      ///< A S(γ): dE/dγ [N·m]
  double stiffness;  ///< A S'(γ) [N·m]
};

/// @param x corners 00, 10, 01, 11
/// @param area [m²]
/// @param shear law: angle [rad] → Curve::Point of force [N/m]
template <class Law>
inline ShearResult evaluateShear(const std::array<Vec3, 4>& x, double area, const Law& shear) {
  const Shear cell(x, area);
  const Curve::Point law = shear(cell.angle());
  return {cell.slope(), area * law.potential, area * law.force, area * law.slope};
}

}  // namespace haptic_cloth
