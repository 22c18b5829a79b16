#include "haptics/velocity_filter.h"

#include <cmath>

namespace haptic_cloth {

Vec3 VelocityFilter::update(const Vec3& moved, bool jumped, double time) {
  const double dt = time - last_time_;
  if (last_time_ < 0.0 || !(dt >= 0.0) || dt > gap_ || jumped) {
    velocity_.setZero();
  } else {
    // Exact response of τ v' = u - v to u = Δx/dt held over dt; its limit for dt → 0 is v + Δx/τ.
    const double ratio = dt / time_constant_;
    const double gain = ratio > 1e-9 ? -std::expm1(-ratio) / ratio : 1.0;
    velocity_ = std::exp(-ratio) * velocity_ + gain / time_constant_ * moved;
  }
  last_time_ = time;
  return velocity_;
}

}  // namespace haptic_cloth
