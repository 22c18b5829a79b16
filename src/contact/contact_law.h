/// Pressure between cloth and solid, and smoothed Coulomb friction: pure functions.
#pragma once

#include <cmath>

namespace haptic_cloth {

/// Normal contact: pressure p(u) = p₀ u²/(1-u) with u = (range - gap)/range, zero from gap = range on, rising
/// without bound towards gap = 0 but continued linearly from u = kSwitch on: never infinite. Soft at first
/// touch, hard when pressed: a light drape keeps the solve well conditioned, a hard push does not get
/// through.
class ContactLaw {
 public:
  struct Point {
    double energy;     ///< per area [J/m²]
    double pressure;   ///< [Pa]
    double stiffness;  ///< -dp/dgap [Pa/m]
  };

  /// @param range gap at which contact begins [m]
  explicit ContactLaw(double range) : range_(range) {}

  double range() const { return range_; }

  /// Gap at which the pressure is as large as it gets before it goes on linearly [m].
  double firmGap() const { return (1.0 - kSwitch) * range_; }

  Point operator()(double gap) const {
    const double u = 1.0 - gap / range_;
    if (u <= 0.0) return {0.0, 0.0, 0.0};
    const double v = u < kSwitch ? u : kSwitch;
    const double energy = -0.5 * v * v - v - std::log1p(-v);
    const double pressure = v * v / (1.0 - v);
    const double slope = v * (2.0 - v) / ((1.0 - v) * (1.0 - v));
    const double past = u - v;
    return {kPressure * range_ * (energy + past * (pressure + 0.5 * past * slope)),
            kPressure * (pressure + past * slope), kPressure / range_ * slope};
  }

  static constexpr double kPressure = 1e4;  ///< p₀ [Pa]: about that of a finger tip pressing with 1 N
  static constexpr double kSwitch = 0.98;   ///< share of the range from which on the pressure is linear

 private:
  double range_;
};

/// Coulomb friction on a sliding distance y over one step, smoothed below y = ε [Li et al. 2020, IPC]:
/// potential f0 with f0' = 2y/ε - y²/ε² for y < ε, else 1.
struct SmoothSlip {
  double potential;  ///< f0 [m]
  double ratio;      ///< f0'/y [1/m], finite at y = 0
  double slope;      ///< (f0'/y)'/y [1/m³], finite where the slip is not zero
};

inline SmoothSlip smoothSlip(double y, double epsilon) {
  if (y >= epsilon) return {y - epsilon / 3.0, 1.0 / y, -1.0 / (y * y * y)};
  const double t = y / epsilon;
  return {epsilon * t * t * (1.0 - t / 3.0), (2.0 - t) / epsilon,
          y > 0.0 ? -1.0 / (epsilon * epsilon * y) : 0.0};
}

}  // namespace haptic_cloth
