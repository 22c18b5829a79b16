#include "ros/input/unit_check.h"

namespace haptic_cloth {
namespace {

constexpr double kFarthest = 5.0;  ///< from the driver's origin; no arm reaches farther [m]
/// Travel of a device over the radius of its workspace; a Touch with 75 mm reaches 0.43 m [-].
constexpr double kReach = 6.0;
constexpr double kFastest = 10.0;  ///< faster than any hand that holds a device [m/s]
/// Shortest interval for a speed, because messages come in bursts [s].
constexpr double kWindow = 0.02;
constexpr double kLongWindow = 0.5;  ///< after a longer silence the speed is unknown [s]
constexpr int kFastWindows = 3;      ///< in a row; a single one may be a tool put down elsewhere
constexpr int kFarPositions = 3;     ///< in a row; a single one may be a fault of the driver

}  // namespace

UnitDoubt UnitCheck::look(const Vec3& position, double received) {
  if (!started_) {
    started_ = true;
    reference_ = window_start_ = position;
    window_begin_ = received;
  } else if (!has_neighbour_) {
    has_neighbour_ = inReach(position);
    if (!has_neighbour_) reference_ = position;
  }
  if (doubt_ != UnitDoubt::None) return doubt_;
  far_positions_ = tooFar(position) ? far_positions_ + 1 : 0;
  if (far_positions_ >= kFarPositions) {
    doubt_ = UnitDoubt::TooFar;
  } else if (tooFast(position, received)) {
    doubt_ = UnitDoubt::TooFast;
  }
  return doubt_;
}

bool UnitCheck::tooFar(const Vec3& position) const {
  if (position.norm() > kFarthest) return true;
  return !inReach(position);
}

/// Tells whether the device reaches a position as well as the reference.
bool UnitCheck::inReach(const Vec3& position) const {
  return workspace_radius_ == 0.0 || (position - reference_).norm() <= kReach * workspace_radius_;
}

bool UnitCheck::tooFast(const Vec3& position, double received) {
  const double elapsed = received - window_begin_;
  if (elapsed < kWindow) return false;
  const bool fast = elapsed < kLongWindow && (position - window_start_).norm() > kFastest * elapsed;
  fast_windows_ = fast ? fast_windows_ + 1 : 0;
  window_start_ = position;
  window_begin_ = received;
  return fast_windows_ >= kFastWindows;
}

std::string toText(UnitDoubt doubt) {
  const std::string remedy =
      "; for a driver in millimetres set device/position_unit to 0.001, for one ten times too large to 0.1";
  switch (doubt) {
    case UnitDoubt::TooFar:
      return "the poses are farther away than a device reaches, were they in metres" + remedy;
    case UnitDoubt::TooFast:
      return "the poses are faster than a hand, were they in metres" + remedy;
    case UnitDoubt::None:
      break;
  }
  return "";
}

}  // namespace haptic_cloth
