#include "fabric/fabric_laws.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace haptic_cloth {
namespace {

constexpr std::size_t kIntervals = 512;  ///< least number of intervals of a sampled law
/// Strain at which compression_ratio takes the tangent stiffness [-]
constexpr double kReferenceStrain = 0.01;
/// Least share of the secant stiffness of the whole test that compression_ratio takes. Fabric that extends
/// far has next to no slope at 1 %, and its threads would shrink wherever they bend.
constexpr double kLeastShare = 0.2;

// Slope after a reversal divided by that of the steeper branch, which KES does not give. In tension
// the branches meet at both ends, so any value keeps the outer loop. In bending and shear the path
// crosses the whole width of the loop at each end; 30 cuts off less than 1.5 % of the area of any
// shipped fabric. Where the loop is wide for the slope of its branches, the path is steeper: it crosses
// within 5 % of the range, which cuts off 2.5 % of the area.
constexpr double kTensileReversal = 3.0;
constexpr double kOddReversal = 30.0;
constexpr double kLongestCrossing = 0.05;  ///< part of the range from zero to the end of the law

constexpr double kBendingEnd = 256.0;                          ///< [1/m]; KES bends to 250 1/m
constexpr double kShearEnd = 8.0 / kes::kDegreesPerRadian;     ///< [rad]; KES shears to 8°
constexpr double kShearNarrow = 0.5 / kes::kDegreesPerRadian;  ///< angle of 2HG [rad]
constexpr double kShearWide = 5.0 / kes::kDegreesPerRadian;    ///< angle of 2HG5 [rad]

std::vector<double> power(double exponent) {
  std::vector<double> forces;
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    forces.push_back(kes::kLargestTension *
                     std::pow(static_cast<double>(i) / static_cast<double>(kIntervals), exponent));
  }
  return forces;
}

std::vector<double> sample(const std::vector<TableRow>& rows, double end, std::size_t count) {
  std::vector<double> forces;
  for (std::size_t i = 0; i <= count; ++i) {
    forces.push_back(interpolate(rows, end * static_cast<double>(i) / static_cast<double>(count)));
  }
  return forces;
}

}  // namespace

double branchAt(const std::vector<double>& forces, double step, double s) {
  const double last = static_cast<double>(forces.size() - 2);
  const auto i = static_cast<std::size_t>(std::clamp(s / step, 0.0, last));
  return forces[i] + (s / step - static_cast<double>(i)) * (forces[i + 1] - forces[i]);
}

HalfLoop kesTensile(double largest_strain, double linearity, double resilience) {
  const double exponent = 2.0 / linearity - 1.0;
  return {largest_strain / kIntervals, power(exponent), power((exponent + 1.0) / resilience - 1.0)};
}

HalfLoop kesBending(double rigidity, double half_width) {
  const double most = rigidity * kBendingEnd;
  return {kBendingEnd, {half_width, most + half_width}, {-half_width, most - half_width}};
}

HalfLoop kesShear(double modulus, double half_width, double half_width5) {
  const double widening = (half_width5 - half_width) / (kShearWide - kShearNarrow);
  const double at_zero = half_width - widening * kShearNarrow, at_end = at_zero + widening * kShearEnd;
  const double most = modulus * kShearEnd;
  return {kShearEnd, {at_zero, most + at_end}, {-at_zero, most - at_end}};
}

HalfLoop linearLaw(double slope, double end) { return {end, {0.0, slope * end}, {0.0, slope * end}}; }

double interpolate(const std::vector<TableRow>& rows, double s) {
  const auto end = std::lower_bound(rows.begin() + 1, rows.end() - 1, s,
                                    [](const TableRow& row, double x) { return row.deformation < x; });
  const TableRow& a = *(end - 1);
  const TableRow& b = *end;
  return a.force + (b.force - a.force) * (s - a.deformation) / (b.deformation - a.deformation);
}

HalfLoop tableLaw(const std::vector<TableRow>& loading, const std::vector<TableRow>& unloading) {
  const std::size_t spans = loading.size() - 1;
  const std::size_t count = (kIntervals + spans - 1) / spans * spans;
  const double end = loading.back().deformation;
  return {end / static_cast<double>(count), sample(loading, end, count),
          sample(unloading.empty() ? loading : unloading, end, count)};
}

HalfLoop meanLaw(const HalfLoop& a, const HalfLoop& b) {
  // Beyond the end of a law both of its branches rise like loading, as in Loop: continued with a slope
  // of its own, the steeper unloading branch of a loop that closes would cross loading.
  const auto unloadingAt = [](const HalfLoop& law, double s) {
    const double inside = std::min(s, law.end());
    const double beyond = branchAt(law.loading, law.step, s) - branchAt(law.loading, law.step, inside);
    return branchAt(law.unloading, law.step, inside) + beyond;
  };
  HalfLoop mean{std::max(a.end(), b.end()) / kIntervals, {}, {}};
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    const double s = mean.step * static_cast<double>(i);
    mean.loading.push_back(0.5 * (branchAt(a.loading, a.step, s) + branchAt(b.loading, b.step, s)));
    mean.unloading.push_back(0.5 * (unloadingAt(a, s) + unloadingAt(b, s)));
  }
  return mean;
}

Loop tensileLoop(const HalfLoop& half, double compression_ratio) {
  // The tangent is a central difference over one interval, so it is defined even if a table has a
  // corner at 1 %.
  const double reach = std::min(0.5 * half.step, kReferenceStrain);
  const double rise = branchAt(half.loading, half.step, kReferenceStrain + reach) -
                      branchAt(half.loading, half.step, kReferenceStrain - reach);
  const double tangent = rise / (2.0 * reach),
               secant = half.loading.back() / (half.step * static_cast<double>(half.loading.size() - 1));
  const double below_zero = -compression_ratio * std::max(tangent, kLeastShare * secant) * half.step;
  std::vector<double> upper{below_zero}, lower{below_zero};
  upper.insert(upper.end(), half.loading.begin(), half.loading.end());
  lower.insert(lower.end(), half.unloading.begin(), half.unloading.end());
  return Loop(-half.step, half.step, upper, lower, kTensileReversal);
}

Loop oddLoop(const HalfLoop& half) {
  // Up to zero the upper branch is the mirrored unloading branch; it must not fall from there on.
  const double at_zero = std::max(half.loading.front(), -half.unloading.front());
  std::vector<double> upper;
  for (auto force = half.unloading.rbegin(); force != half.unloading.rend() - 1; ++force)
    upper.push_back(-*force);
  for (const double force : half.loading) upper.push_back(std::max(force, at_zero));
  std::vector<double> lower(upper.rbegin(), upper.rend());
  for (double& force : lower) force = -force;
  return Loop(-half.end(), half.step, upper, lower, kOddReversal, kLongestCrossing * half.end());
}

}  // namespace haptic_cloth
