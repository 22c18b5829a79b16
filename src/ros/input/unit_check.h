/// Whether positions can be metres of a hand. The commonest mistake of a new driver is millimetres.
#pragma once

#include <string>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

enum class UnitDoubt { None, TooFar, TooFast };

/// Looks at every position. The first doubt stays: what was wrong once is not right because the hand rests.
class UnitCheck {
 public:
  /// @param workspace_radius of the device [m]; 0: not known
  explicit UnitCheck(double workspace_radius) : workspace_radius_(workspace_radius) {}

  /// @param position by the driver, in what is taken for metres
  /// @param received steady clock [s]
  UnitDoubt look(const Vec3& position, double received);

 private:
  bool tooFar(const Vec3& position) const;
  bool tooFast(const Vec3& position, double received);

  double workspace_radius_;
  UnitDoubt doubt_ = UnitDoubt::None;
  bool started_ = false;
  Vec3 first_ = Vec3::Zero();         ///< position
  Vec3 window_start_ = Vec3::Zero();  ///< position
  double window_begin_ = 0.0;         ///< [s]
  int fast_windows_ = 0;              ///< in a row
};

/// What is wrong and what mends it; empty without doubt.
std::string toText(UnitDoubt doubt);

}  // namespace haptic_cloth
