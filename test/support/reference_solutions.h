/// Exact equilibria as references, computed by other means: shooting, closed forms and quadrature.
/// docs/validation.md lists the sources of their own checks.
#pragma once

#include <functional>

namespace haptic_cloth {

/// Strip clamped horizontally at one end under its own weight.
struct Cantilever {
  double tip_angle;       ///< angle below the horizontal [rad]
  double x;               ///< position of the tip over the length [-]
  double drop;            ///< depth of the tip over the length [-]
  double root_curvature;  ///< κ(0) times the bending length c [-]
};

/// Inextensible heavy elastica B θ'' = -w (L - s) cos θ, θ(0) = 0, θ'(L) = 0 (Bickley 1934), by
/// shooting from the tip with RK4 and bisection of the tip angle.
/// @param lambda L / c with c = (B/w)^⅓, 0 < lambda <= 5; beyond, other equilibria exist
Cantilever heavyElastica(double lambda);

/// Chain or strip without bending stiffness, held at two points of equal height.
struct Catenary {
  double sag;         ///< sag over the span [-]
  double horizontal;  ///< tension at the middle over the weight [-]
  double largest;     ///< tension at an end over the weight [-]
};

/// Inextensible catenary. @param length over the span, > 1
Catenary catenary(double length);

/// Elastic catenary with tension = stiffness · strain (Irvine 1981).
/// @param length unstretched, over the span  @param stiffness EA / weight
Catenary elasticCatenary(double length, double stiffness);

/// Extension [m] of a strip that hangs under its own weight: ∫₀ᴸ ε(w s) ds by Simpson's rule.
/// @param weight per area [N/m²]  @param length [m]  @param strain inverse tensile law, N/m → -
double hangingExtension(double weight, double length, const std::function<double(double)>& strain);

/// Fall of a rigid body under backward Euler from rest, without air: x_n = g h² n (n+1) / 2.
double backwardEulerFall(double gravity, double time_step, int steps);

/// Same by BDF2 after a first step by backward Euler: x_n = (4 x_{n-1} - x_{n-2} + 2h g h n)/3 [m].
double bdf2Fall(double gravity, double time_step, int steps);

}  // namespace haptic_cloth
