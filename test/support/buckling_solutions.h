/// Buckled equilibria as references: shooting, elliptic integrals and a power series.
/// The tests of buckling in test/physics/sheet check them against the literature.
#pragma once

namespace haptic_cloth {

/// Strip clamped at its foot that stands under its own weight, with gravity tilted against the
/// strip.
struct HeavyColumn {
  double tip_angle;   ///< angle to the line of the clamp [rad]
  double height;      ///< position of the tip along that line over the length [-]
  double deflection;  ///< position of the tip across it over the length [-]
};

/// Inextensible heavy elastica B θ'' = -w (L - s) sin(θ + tilt), θ(0) = 0, θ'(L) = 0, by shooting
/// from the tip with RK4 and bisection of the tip angle; the equilibrium that leans as gravity
/// does. tilt = π/2 is the horizontal cantilever.
/// @param lambda L / c with c = (B/w)^⅓, 0 < lambda < 5
/// @param tilt 0 < tilt <= π/2 [rad]
HeavyColumn heavyColumn(double lambda, double tilt);

/// λ at which the column without tilt buckles, 1.986353: λ³ = 9/4 j² with j the first zero of J₋₁⸝₃
/// (Greenhill 1881); computed by bisection of the power series of θ'' = -u θ.
double criticalColumn();

/// Inextensible strip whose ends are held closer than its length, pinned or clamped in one line.
/// Its shape consists of two (pinned) or four (clamped) quarter waves.
struct PostBuckled {
  double load;        ///< load over the Euler load of the same ends, π²B/L² or 4π²B/L² [-]
  double deflection;  ///< deflection of the middle over the length [-]
  double bending;     ///< bending energy over Euler load times length [-]
};

/// Solution by elliptic integrals K and E of k = sin(α/2), with α the slope where the moment
/// vanishes: shortening = 2 - 2E/K, load (2K/π)², deflection k/K (Love 1927, art. 263).
/// @param shortening over the length, 0 < shortening < 1
PostBuckled postBuckled(double shortening);

/// Tip of a strip clamped with its wide side upright under its own weight, with a small part of
/// gravity to the side. φ = θ - tilt, the twist relative to the plane of gravity, obeys GJ φ'' +
/// M²/EI φ = 0 with M = q (L - s)²/2 and φ'(L) = 0, so φ is a power series in Γ² (Prandtl 1899).
/// @param gamma Γ = q L³ / √(EI·GJ)
/// @return φ(0) / φ(L): tilt over (tilt - twist at the tip); 1 without load, 0 at buckling
double lateralStiffness(double gamma);

/// First zero of lateralStiffness(), Γ = 12.853763.
double criticalLateral();

}  // namespace haptic_cloth
