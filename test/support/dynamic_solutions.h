/// Exact solutions for moving, hysteretic and supported strips as references, computed by shooting.
/// docs/validation.md lists the sources of their own checks.
#pragma once

#include <functional>
#include <vector>

namespace haptic_cloth {

/// Mode of small swings of a strip that hangs from its top.
struct HangingMode {
  double frequency;           ///< ω √(L/g) [-]
  std::vector<double> shape;  ///< deflection at equal distances from tip (1) to top (0)
};

/// Mode of a chain without bending stiffness: J₀(2 Ω √s), s = distance from the tip over L, J₀(2Ω)
/// = 0 (Bernoulli 1732; Lamb, Dynamical Theory of Sound, art. 30).
/// @param number 1 for the lowest mode @param intervals number of intervals of the shape
HangingMode hangingChainMode(int number, int intervals);

/// Mode of a strip with bending stiffness, clamped at the top: y''''/Γ - (s y')' = Ω² y, y'' = y'''
/// = 0 at the tip, y = y' = 0 at the top, by shooting from the tip.
/// @param gamma Γ = w L³/B
HangingMode hangingStripMode(double gamma, int number, int intervals);

/// Linear oscillation under backward Euler: pole z = 1/(1 - i ω h).
double backwardEulerPhase(double omega_h);  ///< phase per step, atan(ω h) [rad]
/// Energy kept over one period of 2π / phase steps [-].
double backwardEulerEnergy(double omega_h);

/// Linear oscillation under BDF2: (3/2 - i ω h) z² - 2 z + 1/2 = 0, the root that tends to 1 (Hairer,
/// Nørsett, Wanner: Solving ODEs I, III.1).
double bdf2Phase(double omega_h);    ///< phase per step [rad]
double bdf2Frequency(double phase);  ///< ω h of a phase per step, below 1
/// Energy kept over one period of 2π / phase steps [-].
double bdf2Energy(double omega_h);

/// Tip of a strip clamped horizontally at one end under its own weight, for any monotonic bending
/// law.
struct DroopedTip {
  double x, drop;  ///< [m]
};

/// Computes the tip by shooting.
/// @param length [m]  @param weight per area [N/m²]
/// @param curvature curvature for a moment per width >= 0, N → 1/m
DroopedTip droopedStrip(double length, double weight, const std::function<double(double)>& curvature);

/// Strip that hangs over the frictionless sharp edge of a table, its inner end held; lengths in
/// units of c = (B/w)^⅓.
struct OverEdge {
  /// Length that is off the table behind the edge; at its end the strip touches without moment.
  double lift;
  double tip_angle;  ///< angle below the horizontal [rad]
  /// Depth of the tip below the table; also the tension [w c] that holds the strip.
  double drop;
};

/// @param overhang length beyond the edge, 0 < overhang <= 3
OverEdge stripOverEdge(double overhang);

/// Longest overhang b [m] that friction holds, for a limp strip on a table that ends in a quarter
/// circle: T = μwa at the end of the flat part a, dT/dφ = μ(T + wR cos φ) - wR sin φ, T = wb below.
/// For R = 0 the capstan (Euler 1769): b/a = μ e^{μπ/2}.
/// @param flat length on the table [m]  @param radius radius of the edge [m]
double heldOverhang(double flat, double radius, double friction);

}  // namespace haptic_cloth
