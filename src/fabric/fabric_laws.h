/// Force laws of a fabric from KES parameters, linear constants or tables: numbers in, loops out.
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
constexpr double kShearModulus = kForcePerWidth * kDegreesPerRadian;  ///< 1 gf/(cm·deg) [N/m per rad]
}  // namespace kes

/// A row of a measured curve: deformation and force, both in SI.
struct TableRow {
  double deformation;
  double force;
};

/// Force of a table at s within its rows, linear between them.
double interpolate(const std::vector<TableRow>& rows, double s);

/// One half of a loop: forces at 0, step, 2 step, ..., while deformation grows and while it shrinks.
struct HalfLoop {
  double step;
  std::vector<double> loading;
  std::vector<double> unloading;  ///< the same as loading for an elastic law

  double end() const { return step * static_cast<double>(loading.size() - 1); }
};

/// Force of one branch at s ≥ 0, linear between its samples and past the end.
double branchAt(const std::vector<double>& forces, double step, double s);

/// T = F_m (ε/ε_m)^n with n = 2/LT − 1; unloading with n' = (n + 1)/RT − 1, which gives back RT of the work.
/// @param largest_strain ε_m = EMT/100 [-], linearity LT in (0, 1], resilience RT as a fraction in (0, 1]
HalfLoop kesTensile(double largest_strain, double linearity, double resilience);

/// M = B κ ± HB. @param rigidity [N·m]  @param half_width HB [N]
HalfLoop kesBending(double rigidity, double half_width);

/// S = G γ ± h(γ), h linear through half of 2HG at 0.5° and half of 2HG5 at 5°.
/// @param modulus [N/m per rad]  @param half_width, half_width5 [N/m]
HalfLoop kesShear(double modulus, double half_width, double half_width5);

/// f = slope · s.
/// @param end of the sampled part; a power of two, so that dividing by it does not round the slope
HalfLoop linearLaw(double slope, double end);

/// Resamples tables that start at 0. Rows at equal distances keep their corners. @param unloading empty:
/// elastic
HalfLoop tableLaw(const std::vector<TableRow>& loading, const std::vector<TableRow>& unloading);

/// Mean of two laws (shear measured along warp and weft).
HalfLoop meanLaw(const HalfLoop& a, const HalfLoop& b);

/// The law in tension, and below zero a line of slope compression_ratio · (tangent stiffness at 1 % strain).
Loop tensileLoop(const HalfLoop& half, double compression_ratio);

/// The loop that is its own image under a turn by 180°: upper(−s) = −lower(s).
Loop oddLoop(const HalfLoop& half);

}  // namespace haptic_cloth
