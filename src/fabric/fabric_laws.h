/// Force laws of a fabric from KES parameters, linear constants or tables: numbers in, curves out.
///
/// These are the loading curves; the loop (RT, 2HB, 2HG, unloading tables) is read but not used yet.
#pragma once

#include <vector>

#include "haptic_cloth/curve.h"

namespace haptic_cloth {

/// KES units in SI (Kawabata, The Standardization and Analysis of Hand Evaluation, 1980).
namespace kes {
constexpr double kForcePerWidth = 0.980665;      ///< 1 gf/cm [N/m]
constexpr double kLargestTension = 490.3325;     ///< F_m = 500 gf/cm [N/m]
constexpr double kBendingRigidity = 9.80665e-5;  ///< 1 gf·cm²/cm [N·m]
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

/// The loading half of a law: forces at 0, step, 2 step, ...; forces[0] = 0.
struct Loading {
  double step;
  std::vector<double> forces;

  double end() const { return step * static_cast<double>(forces.size() - 1); }
  /// Force at s ≥ 0, linear between the samples and past the end.
  double at(double s) const;
};

/// T = F_m (ε/ε_m)^n with n = 2/LT − 1. @param largest_strain ε_m = EMT/100 [-], linearity LT in (0, 1]
Loading kesTensile(double largest_strain, double linearity);

/// f = slope · s.
/// @param end of the sampled part; a power of two, so that dividing by it does not round the slope
Loading linearLoading(double slope, double end);

/// Resamples a table that starts at 0, 0. Rows at equal distances keep their corners.
Loading tableLoading(const std::vector<TableRow>& rows);

/// Mean of two laws (shear measured along warp and weft).
Loading meanLoading(const Loading& a, const Loading& b);

/// The law in tension, and below zero a line of slope compression_ratio · (tangent stiffness at 1 % strain).
Curve tensileCurve(const Loading& loading, double compression_ratio);

/// f(−s) = −f(s).
Curve oddCurve(const Loading& loading);

}  // namespace haptic_cloth
