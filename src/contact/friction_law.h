/// Smoothed Coulomb friction: pure functions.
#pragma once

#include <cmath>

#include "haptic_cloth/types.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Coulomb friction for a slip y, smoothed below y = ε [Li et al. 2020, IPC]: potential f0 with f0' =
/// 2y/ε - y²/ε² for y < ε, else 1. A step starts with the slip under the friction that the step before
/// left (slipUnder()), so a force below μN is held without motion.
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

/// Second derivative of the friction potential by the position [N/m]. @param limit of the force [N]
inline Block frictionBlock(const Vec3& slip, const Vec3& normal, double limit, double epsilon) {
  const SmoothSlip smooth = smoothSlip(slip.norm(), epsilon);
  return limit * (smooth.ratio * (isotropic(1.0) - square(normal)) + smooth.slope * square(slip));
}

/// Slip over ε under a friction force over its limit μN: the inverse of f0', in the direction of the
/// force. Beyond the limit its length is 1.
inline Vec3 slipUnder(const Vec3& share) {
  const double size = share.norm();
  return size < 1.0 ? Vec3(share / (1.0 + std::sqrt(1.0 - size))) : Vec3(share / size);
}

}  // namespace haptic_cloth
