/// Force laws of a fabric, made from KES parameters, linear constants or tables.
#pragma once

#include <vector>

#include "haptic_cloth/loop.h"

namespace haptic_cloth {

/// KES units in SI (Kawabata, The Standardization and Analysis of Hand Evaluation, 1980).
namespace kes {
constexpr double kForcePerWidth = 0.980665;          ///< 1 gf/cm [N/m]
constexpr double kLargestTension = 490.3325;         ///< F_m = 500 gf/cm [N/m]
constexpr double kBendingRigidity = 9.80665e-5;      ///< 1 gf·cm²/cm [N·m]
constexpr double kHysteresisOfBending = 9.80665e-3;  ///< 1 gf·cm/cm [N]
constexpr double kDegreesPerRadian = 57.2957795130823209;
/// 1 gf/(cm·deg) [N/m per rad]
constexpr double kShearModulus = kForcePerWidth * kDegreesPerRadian;
}  // namespace kes

/// Row of a measured curve: deformation and force in SI units.
struct TableRow {
  double deformation;
  double force;
};

/// Force of a table at s, linear between rows; s must lie within them.
double interpolate(const std::vector<TableRow>& rows, double s);

/// One half of a loop: forces at 0, step, 2 step, ... for growing and for shrinking deformation.
struct HalfLoop {
  double step;
  std::vector<double> loading;
  std::vector<double> unloading;  ///< equal to loading for an elastic law

  double end() const { return step * static_cast<double>(loading.size() - 1); }
};

/// Force of one branch at s ≥ 0, linear between its samples and beyond the end.
double branchAt(const std::vector<double>& forces, double step, double s);

/// Tensile law: T = F_m (ε/ε_m)^n with n = 2/LT − 1; unloading with n' = (n + 1)/RT − 1, which
/// returns the share RT of the work.
/// @param largest_strain ε_m = EMT/100 [-]
/// @param linearity LT in (0, 1]
/// @param resilience RT as a fraction in (0, 1]
HalfLoop kesTensile(double largest_strain, double linearity, double resilience);

/// Bending law: M = B κ ± HB. @param rigidity B [N·m]  @param half_width HB [N]
HalfLoop kesBending(double rigidity, double half_width);

/// Shear law: S = G γ ± h(γ), h linear through half of 2HG at 0.5° and half of 2HG5 at 5°.
/// @param modulus G [N/m per rad]  @param half_width, half_width5 [N/m]
HalfLoop kesShear(double modulus, double half_width, double half_width5);

/// Linear law: f = slope · s.
/// @param end end of the sampled range; a power of two, so that dividing by it does not round the
/// slope
HalfLoop linearLaw(double slope, double end);

/// Resamples tables that start at 0. Equally spaced rows keep their corners.
/// @param unloading empty: elastic
HalfLoop tableLaw(const std::vector<TableRow>& loading, const std::vector<TableRow>& unloading);

/// Mean of two laws (shear measured along warp and weft). Beyond the end of the shorter one its
/// branches continue with the last slope of loading.
HalfLoop meanLaw(const HalfLoop& a, const HalfLoop& b);

/// Complete tensile law: below zero a line with the slope compression_ratio · (tangent stiffness at
/// 1 % strain).
Loop tensileLoop(const HalfLoop& half, double compression_ratio);

/// Odd loop: upper(−s) = −lower(s).
Loop oddLoop(const HalfLoop& half);

}  // namespace haptic_cloth
