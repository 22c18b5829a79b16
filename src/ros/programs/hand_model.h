/// A simulated hand: an intended motion, an arm (spring and damper) and the mass of a device.
#pragma once

#include "haptic_cloth/types.h"
#include "ros/programs/program_options.h"

namespace haptic_cloth {

/// Target of the hand at a time since its start [s]: approach, press, slide, lift, and again.
Vec3 handTarget(const HandOptions& options, double time);

/// Dynamics of the hand: m a = k (target - x) - d v + F.
class HandModel {
 public:
  explicit HandModel(const HandOptions& options) : options_(options), position_(options.start) {}

  /// One implicit Euler step, which is stable for any rate. @param reaction force on the probe [N]; @param dt
  /// [s]
  const Vec3& step(const Vec3& target, const Vec3& reaction, double dt);

 private:
  HandOptions options_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace haptic_cloth
