/// Strips that stand on a floor, or hang in a loop, as references: the planar elastica by shooting with
/// RK4 and Newton's method. L is the length of the strip, B its rigidity.
#pragma once

namespace haptic_cloth {

/// Friction that a weightless strip needs to stand on a floor: horizontal over vertical force on its tip
/// [-]. Its upper end is clamped, straight down; the clamp has come down, and the tip is where it first
/// touched the floor [Romero et al. 2021]. With less the tip slips, and needs ever more as it does.
/// @param lowering of the clamp over L, 0.002 <= lowering <= 0.5 [-]
double frictionToStand(double lowering);

/// Clamps of a loop, side by side and symmetric to the vertical between them.
struct LoopClamps {
  double angle;  ///< of the strip that leaves them outwards, above the horizontal [rad]
  double apart;  ///< distance over L [-]
};

/// Loop of a strip between two clamps, symmetric to the vertical between them.
struct HangingLoop {
  double height;   ///< distance of its lowest point below the clamps over L [-]
  double width;    ///< largest horizontal width over L [-]
  double bending;  ///< bending energy per width over B/L [-]
  double moment;   ///< moment per width at the right clamp over B/L [-]
  double force;    ///< force per width over B/L² with which its sides touch [-]; 0: they do not
};

/// @param gamma Γ = w L³/B
/// @param thickness distance over L at which the sides touch, at one point and without friction
HangingLoop hangingLoop(const LoopClamps& clamps, double gamma, double thickness);

}  // namespace haptic_cloth
