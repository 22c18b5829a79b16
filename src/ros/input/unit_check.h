/// Checks whether positions can be in metres. The commonest mistake of a new driver is millimetres.
#pragma once

#include <string>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

enum class UnitDoubt { None, TooFar, TooFast };

/// Checks every position. A single stray one raises no doubt. The first doubt remains, because a resting
/// hand does not make the unit right.
class UnitCheck {
 public:
  /// @param workspace_radius of the device [m]; 0: unknown
  explicit UnitCheck(double workspace_radius) : workspace_radius_(workspace_radius) {}

  /// @param position from the driver, taken as metres
  /// @param received steady clock [s]
  UnitDoubt look(const Vec3& position, double received);

 private:
  bool tooFar(const Vec3& position) const;
  bool inReach(const Vec3& position) const;
  bool tooFast(const Vec3& position, double received);

  double workspace_radius_;
  UnitDoubt doubt_ = UnitDoubt::None;
  bool started_ = false;
  bool has_neighbour_ = false;        ///< the reference; a stray position has none
  Vec3 reference_ = Vec3::Zero();     ///< first position after which one in its reach came
  Vec3 window_start_ = Vec3::Zero();  ///< position
  double window_begin_ = 0.0;         ///< start of the window [s]
  int fast_windows_ = 0;              ///< fast windows in a row
  int far_positions_ = 0;             ///< far positions in a row
};

/// Fault and remedy as text; empty without doubt.
std::string toText(UnitDoubt doubt);

}  // namespace haptic_cloth
