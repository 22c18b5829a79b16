/// Pressure between cloth and solid: pure functions.
#pragma once

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

/// Pressure law p(u) = p₀ u²/(1-u), u = (range - gap)/range. It is zero from gap = range on and
/// grows towards gap = 0. From u = kSwitch on it continues linearly, so it is never infinite. It is
/// soft at first touch and stiff under load: a light drape keeps the solve well conditioned, and a finger
/// does not push through.
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

  /// Offset of the gap for a sample that begins the step inside a solid. One that was pressed in must not
  /// yield step by step. One that was put there counts as pressed, and less so the deeper it is. With the
  /// largest pressure a cloth that begins in the middle of a ball would be blown up like a balloon and thrown
  /// out.
  double gapOffset(double gap, bool pressed_in) const {
    constexpr double kGentle = 0.2;  // smallest u that counts: p0/20, 500 Pa
    if (pressed_in) return std::max(0.0, -range_ - gap);
    if (!(gap < 0.0)) return 0.0;
    const double firm = range_ - firmGap();
    const double pressed = std::max(std::min(1.0, range_ / -gap) * firm, kGentle * range_);
    return range_ - pressed - gap;
  }

  static constexpr double kPressure = 1e4;  ///< about the pressure of a finger tip at 1 N
  static constexpr double kSwitch = 0.98;   ///< u from which the pressure is linear

 private:
  double range_;
};

}  // namespace haptic_cloth
