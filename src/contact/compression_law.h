/// Pressure between two layers of cloth: pure functions.
#pragma once

#include <algorithm>
#include <cmath>

#include "contact/contact_law.h"
#include "haptic_cloth/fabric.h"

namespace haptic_cloth {

/// Pressure of two layers whose mid-surfaces are a distance g apart. Each layer takes half of the
/// compression, so g is the thickness T of one layer under that pressure. The law of KES-FB3 holds
/// up to P_m = 50 gf/cm². It goes on straight beyond, where a logarithmic barrier is added:
///
///     p(g) = P_m f(x) + P_b v²/(1-v),    x = (T0 - g)/(T0 - Tm),  n = 2/LC - 1,  v = 1 - g/Tm
///     f(x) = x^n  up to x = 1,  else 1 + n (x - 1)
///
/// where negative x and v count as zero. The pressure is zero from T0 on, has a continuous slope,
/// and grows without bound towards g = 0. Without FB3 data Tm is the thickness and the barrier is
/// all there is: the law of ContactLaw without its linear end.
class CompressionLaw {
 public:
  using Point = ContactLaw::Point;

  /// Numbers of the law, as kernels use them.
  struct Constants {
    double range;             ///< T0: distance from which on there is no pressure [m]
    double span;              ///< T0 - Tm [m]
    double pressure;          ///< P_m; 0 without FB3 data [Pa]
    double exponent;          ///< n > 1 [-]
    double barrier_range;     ///< Tm [m]
    double barrier_pressure;  ///< P_b [Pa]
  };

  /// Pressure at which FB3 measures Tm: 50 gf/cm² [Pa].
  static constexpr double kMostMeasured = 4903.325;

  explicit CompressionLaw(const Fabric& fabric) {
    if (const auto& measured = fabric.compression) {
      constants_ = {measured->thickness,
                    measured->thickness - measured->pressed_thickness,
                    kMostMeasured,
                    2.0 / measured->linearity - 1.0,
                    measured->pressed_thickness,
                    kMostMeasured};
    } else {
      constants_ = {fabric.thickness, fabric.thickness, 0.0, 2.0, fabric.thickness, ContactLaw::kPressure};
    }
  }

  const Constants& constants() const { return constants_; }
  double range() const { return constants_.range; }  ///< distance at which layers touch [m]

  /// Distance that a change of the mesh must leave between layers [m]. At it the law of FB3 stores P_m Tm
  /// beyond its largest pressure, about as much as the barrier gains where a distance is halved. So a steep
  /// law makes no more energy than others. Without FB3 data it is 0.
  double leastRoom() const {
    const Constants& c = constants_;
    if (c.pressure == 0.0) return 0.0;
    const double stiffness = c.pressure * c.exponent / c.span;
    const double way =
        (std::sqrt(c.pressure * c.pressure + 2.0 * stiffness * c.pressure * c.barrier_range) - c.pressure) /
        stiffness;
    return std::max(0.0, c.barrier_range - way);
  }

  /// @param distance g > 0 [m]
  Point operator()(double distance) const {
    const Constants& c = constants_;
    Point sum{0.0, 0.0, 0.0};
    const double x = (c.range - distance) / c.span;
    if (x > 0.0) {
      const double tested = std::min(x, 1.0), past = x - tested;
      const double steep = std::pow(tested, c.exponent - 1.0), slope = c.exponent * steep;
      const double pressure = steep * tested + past * slope;
      sum = {c.pressure * c.span *
                 (steep * tested * tested / (c.exponent + 1.0) + past * (1.0 + 0.5 * past * slope)),
             c.pressure * pressure, c.pressure * slope / c.span};
    }
    const double left = distance / c.barrier_range, v = 1.0 - left;
    if (v > 0.0) {
      sum.energy += c.barrier_pressure * c.barrier_range * (-0.5 * v * v - v - std::log(left));
      sum.pressure += c.barrier_pressure * v * v / left;
      sum.stiffness += c.barrier_pressure / c.barrier_range * v * (2.0 - v) / (left * left);
    }
    return sum;
  }

 private:
  Constants constants_;
};

}  // namespace haptic_cloth
