/// Shear of one cell: E = A ψ(γ). With the mean sides u, v along warp and weft, D = u · v and
/// S = |u × v|, tan γ = D/√(S² + c²). γ is an angle, so stretching along the threads does no work on it.
///
/// The tiny area c = kFlat A lets the angle of a cell that collapses go to zero. Otherwise a side without
/// length, whose direction is rounding, would store any energy up to A ψ(90°). kFlat is far above the
/// rounding of positions, 1e-13 of a side, and far below any side that cloth can have.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

constexpr double kFlat = 1e-9;  // c over the rest area of a cell

/// Derivative of the angle by the corners.
struct ShearSlope {
  /// dγ/dx of corner 11 (corner 00: the negative) and of corner 10 (corner 01: the negative) [1/m].
  Vec3 rising, falling;
};

/// Shear of a cell at one place of its corners.
class Shear {
 public:
  /// @param x corners 00, 10, 01, 11 [m]
  /// @param area rest area [m²], more than 0
  Shear(const std::array<Vec3, 4>& x, double area)
      : u_(alongWarp(x)),
        v_(alongWeft(x)),
        uu_(u_.squaredNorm()),
        vv_(v_.squaredNorm()),
        product_(u_.dot(v_)) {
    const double flat = 4.0 * kFlat * area;  // the sides are twice the mean ones
    size_ = std::sqrt(std::max(0.0, uu_ * vv_ - product_ * product_) + flat * flat);
    square_ = uu_ * vv_ + flat * flat;
  }

  /// Angle γ [rad].
  double angle() const { return std::atan2(product_, size_); }

  ShearSlope slope() const {
    const double a = 1.0 / size_, b = product_ / (size_ * square_);
    return byCorners(a * v_ - b * vv_ * u_, a * u_ - b * uu_ * v_);
  }

  /// Change of the slope for a motion d, to first order. @param d motion of the corners [m]
  ShearSlope slopeChange(const std::array<Vec3, 4>& d) const {
    const Vec3 u_rate = alongWarp(d), v_rate = alongWeft(d);
    const double uu_rate = 2.0 * u_.dot(u_rate), vv_rate = 2.0 * v_.dot(v_rate);
    const double product_rate = u_rate.dot(v_) + u_.dot(v_rate);
    const double square_rate = uu_rate * vv_ + uu_ * vv_rate;
    const double size_rate = (0.5 * square_rate - product_ * product_rate) / size_;
    const double a = 1.0 / size_, b = product_ / (size_ * square_);
    const double a_rate = -a * size_rate / size_;
    const double b_rate = product_rate / (size_ * square_) - b * (size_rate / size_ + square_rate / square_);
    return byCorners(a_rate * v_ + a * v_rate - (b_rate * vv_ + b * vv_rate) * u_ - b * vv_ * u_rate,
                     a_rate * u_ + a * u_rate - (b_rate * uu_ + b * uu_rate) * v_ - b * uu_ * v_rate);
  }

 private:
  /// Twice the mean side along warp or weft.
  static Vec3 alongWarp(const std::array<Vec3, 4>& x) { return x[3] - x[0] + x[1] - x[2]; }
  static Vec3 alongWeft(const std::array<Vec3, 4>& x) { return x[3] - x[0] - x[1] + x[2]; }
  static ShearSlope byCorners(const Vec3& du, const Vec3& dv) { return {du + dv, du - dv}; }

  Vec3 u_, v_;                ///< twice the mean sides [m]
  double uu_, vv_, product_;  ///< u², v², D [m²]
  double size_, square_;      ///< √(S² + c²) [m²], u² v² + c² [m⁴]
};

}  // namespace haptic_cloth
