/// Smoothed Coulomb friction in lanes.
#pragma once

#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

/// f0'/y of smoothSlip() (friction_law.h) for a slip of length y [1/m].
HAPTIC_CLOTH_INLINE Lanes slipRatio(const Lanes& y, double epsilon) {
  const Lanes short_end = all(epsilon);
  return ifLess(y, short_end, (2.0 - y / epsilon) / short_end, 1.0 / larger(y, short_end));
}

/// SmoothSlip without its slope.
struct SlipLanes {
  Lanes potential;  ///< f0 [m]
  Lanes ratio;      ///< f0'/y [1/m]
};

/// smoothSlip() of a slip in the tangent plane [m].
HAPTIC_CLOTH_INLINE SlipLanes smoothSlip(const Lanes3& slip, double epsilon) {
  const Lanes y = squareRoot(dot(slip, slip)), t = y / epsilon, short_end = all(epsilon);
  return {ifLess(y, short_end, short_end * t * t * (1.0 - t / 3.0), y - short_end / 3.0),
          slipRatio(y, epsilon)};
}

/// Friction along a motion: how its force changes, times the motion [J].
struct FrictionForm {
  Lanes begins;  ///< at the rate with which the change begins: what slides on is not held
  Lanes whole;   ///< over the whole motion: what turns back is held, and what breaks loose is not
};

/// Both values for a contact that slips.
/// @param moved motion; a part along the normal has no effect [m]
/// @param square of the motion in the tangent plane [m²]
/// @param limit of the force [N]
/// @param ratio force over slip now [N/m]
HAPTIC_CLOTH_INLINE FrictionForm frictionForm(const Lanes3& slip, const Lanes3& moved, const Lanes& square,
                                              const Lanes& limit, const Lanes& ratio, double epsilon) {
  constexpr double kLeast = 1e-8;  // of epsilon: slip so small has no direction
  const Lanes towards = dot(slip, moved), y = squareRoot(dot(slip, slip)),
              end = squareRoot(larger(y * y + 2.0 * towards + square, Lanes{})),
              beyond = larger(y, all(epsilon));
  const Lanes falls = limit / (larger(y, all(kLeast * epsilon)) * beyond * beyond);  // -(f0'/y)'/y
  return {larger(ratio * square - falls * towards * towards, Lanes{}),
          larger(limit * slipRatio(end, epsilon) * (towards + square) - ratio * towards, Lanes{})};
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
