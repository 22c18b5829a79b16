#include "haptic_cloth/admittance.h"

#include <Eigen/LU>
#include <cmath>

#include "haptics/limits.h"

namespace haptic_cloth {

void AdmittanceTool::place(const Vec3& position) {
  position_ = position;
  velocity_.setZero();
}

/// (m + h b + h B + h² K) Δv = h (F - b v - h K v): Euler's implicit step of what is linear around here.
void AdmittanceTool::move(const Vec3& force, const Mat3& stiffness, const Mat3& damping, double time) {
  const double own = options_.mass + time * options_.damping;
  const Mat3 inertia = own * Mat3::Identity() + time * damping + time * time * stiffness;
  const Vec3 pull = force - options_.damping * velocity_ - time * stiffness * velocity_;
  velocity_ += limited(time * inertia.inverse() * pull, time * options_.max_acceleration);
  velocity_ = limited(velocity_, options_.max_speed);
  advance(time);
}

void AdmittanceTool::brake(double time) {
  velocity_ = approach(velocity_, Vec3::Zero(), time * options_.max_acceleration);
  advance(time);
}

/// Near a side of the workspace only as fast as can still be stopped within max_acceleration: v h + v²/2a is
/// at most what is left. A tool that was placed outside can only come in.
void AdmittanceTool::advance(double time) {
  const double a = options_.max_acceleration;
  const auto fastest = [&](double room) {
    return room > 0.0 ? a * (std::sqrt(time * time + 2.0 * room / a) - time) : 0.0;
  };
  for (int c = 0; c < 3; ++c) {
    const double down = fastest(position_[c] - options_.workspace_low[c]),
                 up = fastest(options_.workspace_high[c] - position_[c]);
    velocity_[c] = std::fmin(std::fmax(velocity_[c], -down), up);
  }
  position_ += time * velocity_;
}

}  // namespace haptic_cloth
