/// A simulated hand: an intended motion, an arm (spring and damper) and the mass of a device.
#pragma once

#include "haptic_cloth/types.h"
#include "ros/options/parameter_group.h"

namespace haptic_cloth {

/// Intended motion of the hand and properties of the arm. The defaults fit demo.yaml and
/// box_drape.yaml in config/scenes. Their draped top lies at about z = 0.055 m, so the probe's
/// centre first touches it at about 0.063 m.
struct HandOptions {
  Vec3 start{-0.03, 0.0, 0.14};    ///< waiting position above the cloth [m]
  Vec3 press{-0.03, 0.0, 0.050};   ///< target of the pressing hand [m]
  Vec3 slide{0.06, 0.0, 0.0};      ///< displacement while it presses [m]
  double delay = 2.0;              ///< before the first approach [s]
  double approach_time = 1.5;      ///< down to the press point [s]
  double hold_time = 0.5;          ///< at both ends of the slide, and above [s]
  double slide_time = 2.0;         ///< [s]
  double lift_time = 1.0;          ///< [s]
  double mass = 0.1;               ///< mass of device and finger [kg]
  double stiffness = 300.0;        ///< stiffness of the arm [N/m]
  double damping = 8.0;            ///< damping of the arm [N·s/m]
  double rate = 1000.0;            ///< poses per second [Hz]
  std::string frame_id = "world";  ///< frame of the poses
};

/// @throws InputError for an unknown key, a wrong type or an invalid value
HandOptions readHandOptions(ParameterGroup group);

/// Target of the hand at a time since its start [s]: approach, press, slide, lift, and again.
Vec3 handTarget(const HandOptions& options, double time);

/// Dynamics of the hand: m a = k (target - x) - d v + F.
class HandModel {
 public:
  explicit HandModel(const HandOptions& options) : options_(options), position_(options.start) {}

  /// One semi-implicit Euler step. @param reaction force on the probe [N]; @param dt [s]
  const Vec3& step(const Vec3& target, const Vec3& reaction, double dt);

 private:
  HandOptions options_;
  Vec3 position_;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace haptic_cloth
