/// Exact solutions of moving, hysteretic and supported strips that the cloth is compared with, computed here
/// by shooting. docs/validation.md lists the sources of the checks on these themselves.
#pragma once

#include <functional>
#include <vector>

namespace haptic_cloth {

/// Small swing of a strip that hangs from its top.
struct HangingMode {
  double frequency;           ///< ω √(L/g) [-]
  std::vector<double> shape;  ///< deflection at equal distances from the tip (first) to the top, tip = 1
};

/// Chain without bending: J₀(2 Ω √s), s from the tip over L, J₀(2Ω) = 0 (Bernoulli 1732; Lamb, Dynamical
/// Theory of Sound, art. 30). @param number 1 ... @param intervals of the shape
HangingMode hangingChainMode(int number, int intervals);

/// Clamped at the top, with bending: y''''/Γ - (s y')' = Ω² y, y'' = y''' = 0 at the tip, y = y' = 0 at the
/// top, by shooting from the tip. @param gamma Γ = w L³/B
HangingMode hangingStripMode(double gamma, int number, int intervals);

/// What backward Euler makes of a linear oscillation: the pole z = 1/(1 - i ω h).
double backwardEulerPhase(double omega_h);   ///< a step, atan(ω h) [rad]
double backwardEulerEnergy(double omega_h);  ///< kept over one period of 2π / phase steps [-]

/// Tip of a strip clamped horizontally at one end under its own weight, for any law of bending on the way in.
struct DroopedTip {
  double x, drop;  ///< [m]
};

/// @param length [m]  @param weight per area [N/m²]  @param curvature that a moment per width, always >= 0,
/// bends the strip to, N → 1/m
DroopedTip droopedStrip(double length, double weight, const std::function<double(double)>& curvature);

/// Strip that hangs over the frictionless sharp edge of a table, its inner end held; in units of c = (B/w)^⅓.
struct OverEdge {
  double lift;       ///< length off the table behind the edge; there it touches with no moment
  double tip_angle;  ///< below the horizontal [rad]
  double drop;       ///< of the tip below the table, and the tension [w c] that holds the strip
};

/// @param overhang length over the edge, 0 < overhang <= 3
OverEdge stripOverEdge(double overhang);

/// Longest overhang b [m] that friction holds, of a limp strip on a table that ends in a quarter circle: T =
/// μwa at the foot of the flat part a, dT/dφ = μ(T + wR cos φ) - wR sin φ, T = wb below. For R = 0 the
/// capstan (Euler 1769): b/a = μ e^{μπ/2}.
/// @param flat length on the table [m]  @param radius of the edge [m]
double heldOverhang(double flat, double radius, double friction);

}  // namespace haptic_cloth
