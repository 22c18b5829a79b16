/// Shear of one cell: E = A ψ(γ). With the mean sides u, v along warp and weft, D = u · v and
/// S = |u × v|, tan γ = D/√(S² + c²). γ is an angle, so stretching along the threads does no work on it.
///
/// Where a cell is folded within itself, its mean sides lose their length, and their directions say nothing
/// of shear. Without c any small motion would then change γ by any amount. With B = kFolded A² the area c is
/// tiny down to u² v² = B and grows below: c² = (kFlat A)² + (B - u² v²)²/(2B). So γ goes to zero with the
/// sides, and its slope stays below 3.5 |v|/A by u and 3.5 |u|/A by v. kFlat keeps long parallel sides from
/// a division by zero, far above the rounding of positions, 1e-13 of a side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

constexpr double kFlat = 1e-9;    // least c over the rest area of a cell
constexpr double kFolded = 0.25;  // u² v² of a folded cell over its rest area squared

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
    const double full = 4.0 * area, flat = kFlat * full;  // the sides are twice the mean ones
    folded_ = kFolded * full * full;
    missing_ = std::max(0.0, folded_ - uu_ * vv_);
    const double padding = flat * flat + 0.5 * missing_ * missing_ / folded_;
    size_ = std::sqrt(std::max(0.0, uu_ * vv_ - product_ * product_) + padding);
    square_ = uu_ * vv_ + padding;
  }

  /// Angle γ [rad].
  double angle() const { return std::atan2(product_, size_); }

  ShearSlope slope() const {
    const double a = 1.0 / size_, b = product_ * widening() / (size_ * square_);
    return byCorners(a * v_ - b * vv_ * u_, a * u_ - b * uu_ * v_);
  }

  /// Change of the slope for a motion d, to first order. @param d motion of the corners [m]
  ShearSlope slopeChange(const std::array<Vec3, 4>& d) const {
    const Vec3 u_rate = alongWarp(d), v_rate = alongWeft(d);
    const double uu_rate = 2.0 * u_.dot(u_rate), vv_rate = 2.0 * v_.dot(v_rate);
    const double product_rate = u_rate.dot(v_) + u_.dot(v_rate);
    const double both_rate = uu_rate * vv_ + uu_ * vv_rate, square_rate = widening() * both_rate;
    const double widening_rate = missing_ > 0.0 ? both_rate / folded_ : 0.0;
    const double size_rate = (0.5 * square_rate - product_ * product_rate) / size_;
    const double a = 1.0 / size_, b = product_ * widening() / (size_ * square_);
    const double a_rate = -a * size_rate / size_;
    const double b_rate = (product_rate * widening() + product_ * widening_rate) / (size_ * square_) -
                          b * (size_rate / size_ + square_rate / square_);
    return byCorners(a_rate * v_ + a * v_rate - (b_rate * vv_ + b * vv_rate) * u_ - b * vv_ * u_rate,
                     a_rate * u_ + a * u_rate - (b_rate * uu_ + b * uu_rate) * v_ - b * uu_ * v_rate);
  }

 private:
  double widening() const { return 1.0 - missing_ / folded_; }  ///< derivative of u² v² + c² by u² v²
  /// Twice the mean side along warp or weft.
  static Vec3 alongWarp(const std::array<Vec3, 4>& x) { return x[3] - x[0] + x[1] - x[2]; }
  static Vec3 alongWeft(const std::array<Vec3, 4>& x) { return x[3] - x[0] - x[1] + x[2]; }
  static ShearSlope byCorners(const Vec3& du, const Vec3& dv) { return {du + dv, du - dv}; }

  Vec3 u_, v_;                ///< twice the mean sides [m]
  double uu_, vv_, product_;  ///< u², v², D [m²]
  double folded_, missing_;   ///< B, and what u² v² lacks of it [m⁴]
  double size_, square_;      ///< √(S² + c²) [m²], u² v² + c² [m⁴]
};

}  // namespace haptic_cloth
