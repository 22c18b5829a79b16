/// Shear of one cell: E = A ψ(γ), sin γ = û · v̂, with the mean sides u, v along warp and weft. γ
/// is an angle, so stretching along the threads does no work on it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

constexpr double kLeastCosine = 1e-3;  // bounds the slope of a cell that is folded flat

/// Shear angle γ [rad]. @param x corners 00, 10, 01, 11
inline double shearAngle(const std::array<Vec3, 4>& x) {
  const Vec3 u = x[3] - x[0] + x[1] - x[2], v = x[3] - x[0] - x[1] + x[2];
  const double scale = u.norm() * v.norm();
  return scale > 0.0 ? std::asin(std::clamp(u.dot(v) / scale, -1.0, 1.0)) : 0.0;
}

/// Derivative of the angle by the corners.
struct ShearSlope {
  /// dγ/dx of corner 11 (corner 00: the negative) and of corner 10 (corner 01: the negative) [1/m].
  Vec3 rising, falling;
};

/// @param x corners 00, 10, 01, 11
inline ShearSlope shearSlope(const std::array<Vec3, 4>& x) {
  const Vec3 rising = x[3] - x[0], falling = x[1] - x[2];
  const Vec3 u = rising + falling, v = rising - falling;  // twice the mean sides
  const double nu = u.norm(), nv = v.norm();
  if (!(nu * nv > 0.0)) return {Vec3::Zero(), Vec3::Zero()};
  const Vec3 uu = u / nu, vv = v / nv;
  const double sine = std::clamp(uu.dot(vv), -1.0, 1.0);
  const double cosine = std::max(std::sqrt(1.0 - sine * sine), kLeastCosine);
  const Vec3 du = (vv - sine * uu) / (nu * cosine), dv = (uu - sine * vv) / (nv * cosine);
  return {du + dv, du - dv};
}

/// Change of the slope at corners x for a motion d, to first order.
/// @param x, d corners 00, 10, 01, 11
inline ShearSlope shearSlopeChange(const std::array<Vec3, 4>& x, const std::array<Vec3, 4>& d) {
  const auto sides = [](const std::array<Vec3, 4>& c) {
    const Vec3 rising = c[3] - c[0], falling = c[1] - c[2];
    return std::pair<Vec3, Vec3>(rising + falling, rising - falling);
  };
  const auto [u, v] = sides(x);
  const auto [u_rate, v_rate] = sides(d);
  const double nu = u.norm(), nv = v.norm();
  if (!(nu * nv > 0.0)) return {Vec3::Zero(), Vec3::Zero()};
  const Vec3 uu = u / nu, vv = v / nv;
  const double nu_rate = uu.dot(u_rate), nv_rate = vv.dot(v_rate);
  const Vec3 uu_rate = (u_rate - nu_rate * uu) / nu, vv_rate = (v_rate - nv_rate * vv) / nv;
  const double sine = std::clamp(uu.dot(vv), -1.0, 1.0);
  const double sine_rate = uu_rate.dot(vv) + uu.dot(vv_rate);
  const double root = std::sqrt(1.0 - sine * sine);
  const double cosine = std::max(root, kLeastCosine);
  const double cosine_rate = root > kLeastCosine ? -sine * sine_rate / cosine : 0.0;
  const Vec3 du = (vv - sine * uu) / (nu * cosine), dv = (uu - sine * vv) / (nv * cosine);
  const Vec3 du_rate = (vv_rate - sine_rate * uu - sine * uu_rate) / (nu * cosine) -
                       (nu_rate / nu + cosine_rate / cosine) * du;
  const Vec3 dv_rate = (uu_rate - sine_rate * vv - sine * vv_rate) / (nv * cosine) -
                       (nv_rate / nv + cosine_rate / cosine) * dv;
  return {du_rate + dv_rate, du_rate - dv_rate};
}

}  // namespace haptic_cloth
