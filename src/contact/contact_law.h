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

  /// @param firmest gap from which on the pressure grows no more [m]
  Point operator()(double gap, double firmest = kNoLimit) const {
    const double over = std::max(0.0, firmest - gap), u = 1.0 - (gap + over) / range_;
    if (u <= 0.0) return {0.0, 0.0, 0.0};
    const double v = u < kSwitch ? u : kSwitch;
    const double energy = -0.5 * v * v - v - std::log1p(-v);
    const double pressure = v * v / (1.0 - v);
    const double slope = v * (2.0 - v) / ((1.0 - v) * (1.0 - v));
    const double past = u - v;
    const double whole = kPressure * (pressure + past * slope);
    return {kPressure * range_ * (energy + past * (pressure + 0.5 * past * slope)) + over * whole, whole,
            over > 0.0 ? 0.0 : kPressure / range_ * slope};
  }

  /// How the gap of a sample counts in a step.
  struct Count {
    double offset;   ///< added to the gap [m]
    double firmest;  ///< counted gap from which on the pressure grows no more [m]
  };

  /// Counts a gap at the start of a step. Inside a solid, a sample that was pressed in must not yield step by
  /// step. One that was put there counts as pressed, and less so the deeper it is. With the largest pressure
  /// a cloth that begins in the middle of a ball would be blown up like a balloon and thrown out. A solid
  /// that moves on into such cloth would add its way to what counts as pressed: its pressure has a limit.
  Count count(double gap, bool pressed_in) const {
    constexpr double kGentle = 0.2;  // smallest u that counts: p0/20, 500 Pa
    if (pressed_in) return {std::max(0.0, -range_ - gap), kNoLimit};
    if (!(gap < 0.0)) return {0.0, kNoLimit};
    const double firm = range_ - firmGap();
    const double pressed = std::max(std::min(1.0, range_ / -gap) * firm, kGentle * range_);
    return {range_ - pressed - gap, range_ - pressed - firmGap()};
  }

  static constexpr double kPressure = 1e4;    ///< about the pressure of a finger tip at 1 N
  static constexpr double kSwitch = 0.98;     ///< u from which the pressure is linear
  static constexpr double kNoLimit = -1e150;  ///< a gap that nothing has [m]

 private:
  double range_;
};

}  // namespace haptic_cloth
