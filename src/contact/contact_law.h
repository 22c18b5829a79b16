/// Pressure between cloth and solid, and smoothed Coulomb friction: pure functions.
#pragma once

#include <cmath>

namespace haptic_cloth {

/// Pressure law p(u) = p₀ u²/(1-u), u = (range - gap)/range. It is zero from gap = range on and
/// grows towards gap = 0. From u = kSwitch on it continues linearly, so it is never infinite. It is
/// soft at first touch and stiff under load: a light drape keeps the solve well conditioned, a hard
/// push does not pass through.
class ContactLaw {
 public:
  struct Point {
    double energy;     ///< energy per area [J/m²]
    double pressure;   ///< [Pa]
    double stiffness;  ///< -dp/dgap [Pa/m]
  };

  /// @param range gap at which contact begins [m]
  explicit ContactLaw(double range) : range_(range) {}

  double range() const { return range_; }

  /// Gap below which the pressure is linear [m].
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

  static constexpr double kPressure = 1e4;  ///< about the pressure of a finger tip at 1 N
  static constexpr double kSwitch = 0.98;   ///< u from which the pressure is linear

 private:
  double range_;
};

/// Coulomb friction for a slip y in one step, smoothed below y = ε [Li et al. 2020, IPC]: potential
/// f0 with f0' = 2y/ε - y²/ε² for y < ε, else 1.
struct SmoothSlip {
  double potential;  ///< f0 [m]
  double ratio;      ///< f0'/y [1/m], finite at y = 0
  double slope;      ///< (f0'/y)'/y [1/m³], set to 0 at y = 0
};

inline SmoothSlip smoothSlip(double y, double epsilon) {
  if (y >= epsilon) return {y - epsilon / 3.0, 1.0 / y, -1.0 / (y * y * y)};
  const double t = y / epsilon;
  return {epsilon * t * t * (1.0 - t / 3.0), (2.0 - t) / epsilon,
          y > 0.0 ? -1.0 / (epsilon * epsilon * y) : 0.0};
}

}  // namespace haptic_cloth
