/// Vectors kept within limits.
#pragma once

#include <cmath>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Shortens a vector to `limit`; keeps its direction. Zero if it is not finite.
inline Vec3 limited(const Vec3& vector, double limit) {
  const double norm = vector.norm();
  if (!std::isfinite(norm)) return Vec3::Zero();
  return norm > limit ? Vec3(vector * (limit / norm)) : vector;
}

/// Factor by which limited() scales `vector` [-]; 0 if it is not finite.
inline double shareWithin(const Vec3& vector, double limit) {
  const double norm = vector.norm();
  if (!std::isfinite(norm)) return 0.0;
  return norm > limit ? limit / norm : 1.0;
}

/// Makes a step of at most `step` from `from` towards `to`, which it reaches exactly.
inline Vec3 approach(const Vec3& from, const Vec3& to, double step) {
  const Vec3 change = to - from;
  const double norm = change.norm();
  return norm > step ? Vec3(from + change * (step / norm)) : to;
}

}  // namespace haptic_cloth
