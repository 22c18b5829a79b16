#include "fabric/fabric_laws.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace haptic_cloth {
namespace {

constexpr std::size_t kIntervals = 512;    ///< of a sampled law, at least
constexpr double kReferenceStrain = 0.01;  ///< where compression_ratio takes the tensile stiffness [-]

}  // namespace

double Loading::at(double s) const {
  const double last = static_cast<double>(forces.size() - 2);
  const auto i = static_cast<std::size_t>(std::clamp(s / step, 0.0, last));
  return forces[i] + (s / step - static_cast<double>(i)) * (forces[i + 1] - forces[i]);
}

Loading kesTensile(double largest_strain, double linearity) {
  const double exponent = 2.0 / linearity - 1.0;
  Loading loading{largest_strain / kIntervals, {}};
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    loading.forces.push_back(kes::kLargestTension *
                             std::pow(static_cast<double>(i) / static_cast<double>(kIntervals), exponent));
  }
  return loading;
}

Loading linearLoading(double slope, double end) { return {end, {0.0, slope * end}}; }

double interpolate(const std::vector<TableRow>& rows, double s) {
  std::size_t row = 0;
  while (row + 2 < rows.size() && rows[row + 1].deformation < s) ++row;
  const TableRow& a = rows[row];
  const TableRow& b = rows[row + 1];
  return a.force + (b.force - a.force) * (s - a.deformation) / (b.deformation - a.deformation);
}

Loading tableLoading(const std::vector<TableRow>& rows) {
  const std::size_t spans = rows.size() - 1;
  const std::size_t count = (kIntervals + spans - 1) / spans * spans;
  const double end = rows.back().deformation;
  Loading loading{end / static_cast<double>(count), {}};
  for (std::size_t i = 0; i <= count; ++i) {
    loading.forces.push_back(interpolate(rows, end * static_cast<double>(i) / static_cast<double>(count)));
  }
  return loading;
}

Loading meanLoading(const Loading& a, const Loading& b) {
  const double end = std::max(a.end(), b.end());
  Loading mean{end / kIntervals, {}};
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    const double s = end * static_cast<double>(i) / static_cast<double>(kIntervals);
    mean.forces.push_back(0.5 * (a.at(s) + b.at(s)));
  }
  return mean;
}

Curve tensileCurve(const Loading& loading, double compression_ratio) {
  // The tangent is a central difference over one sample, so that a corner of a table at 1 % has one answer.
  const double half = std::min(0.5 * loading.step, kReferenceStrain);
  const double rise = loading.at(kReferenceStrain + half) - loading.at(kReferenceStrain - half);
  const double compression_stiffness = compression_ratio * rise / (2.0 * half);
  std::vector<double> forces{-compression_stiffness * loading.step};
  forces.insert(forces.end(), loading.forces.begin(), loading.forces.end());
  return Curve(-loading.step, loading.step, forces);
}

Curve oddCurve(const Loading& loading) {
  std::vector<double> forces;
  for (auto force = loading.forces.rbegin(); force != loading.forces.rend(); ++force)
    forces.push_back(-*force);
  forces.insert(forces.end(), loading.forces.begin() + 1, loading.forces.end());
  return Curve(-loading.end(), loading.step, forces);
}

}  // namespace haptic_cloth
