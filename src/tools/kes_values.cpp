#include "tools/kes_values.h"

#include "fabric/fabric_laws.h"

namespace haptic_cloth {
namespace {

constexpr double kWork = 0.980665;      ///< 1 gf·cm/cm² [J/m²]
constexpr double kPerCentimetre = 100;  ///< 1/cm [1/m]

/// Force at s on the last sweep that passes it rising, or falling.
double forceAt(const std::vector<KesRow>& rows, double s, bool rising) {
  for (std::size_t k = rows.size() - 1; k > 0; --k) {
    const KesRow &a = rows[k - 1], &b = rows[k];
    const double width = b.deformation - a.deformation;
    if ((width > 0.0) != rising) continue;
    const double t = (s - a.deformation) / width;
    if (t >= 0.0 && t <= 1.0) return a.force + t * (b.force - a.force);
  }
  return 0.0;
}

double width(const std::vector<KesRow>& rows, double s) {
  return forceAt(rows, s, true) - forceAt(rows, s, false);
}

/// Mean slope of both branches from s1 to s2, on both sides of zero.
double slope(const std::vector<KesRow>& rows, double s1, double s2) {
  double sum = 0.0;
  for (const bool rising : {true, false}) {
    for (const double sign : {1.0, -1.0}) {
      sum += sign * (forceAt(rows, sign * s2, rising) - forceAt(rows, sign * s1, rising));
    }
  }
  return 0.25 * sum / (s2 - s1);
}

double work(const std::vector<KesRow>& rows, std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t k = first + 1; k <= last; ++k) {
    sum += 0.5 * (rows[k].force + rows[k - 1].force) * (rows[k].deformation - rows[k - 1].deformation);
  }
  return sum;
}

}  // namespace

std::vector<std::pair<std::string, double>> kesValues(const std::vector<KesRow>& rows, KesTest test) {
  if (test == KesTest::Tensile) {
    const std::size_t top = rows.size() / 2;
    const double most = rows[top].deformation, done = work(rows, 0, top);
    return {{"EMT", 100.0 * most},
            {"LT", done / (0.5 * rows[top].force * most)},
            {"WT", done / kWork},
            {"RT", -100.0 * work(rows, top, rows.size() - 1) / done}};
  }
  if (test == KesTest::Shear) {
    const double degree = 1.0 / kes::kDegreesPerRadian;
    return {{"G", slope(rows, 0.5 * degree, 2.5 * degree) / kes::kShearModulus},
            {"2HG", width(rows, 0.5 * degree) / kes::kForcePerWidth},
            {"2HG5", width(rows, 5.0 * degree) / kes::kForcePerWidth}};
  }
  return {{"B", slope(rows, 0.5 * kPerCentimetre, 1.5 * kPerCentimetre) / kes::kBendingRigidity},
          {"2HB", width(rows, kPerCentimetre) / kes::kHysteresisOfBending}};
}

}  // namespace haptic_cloth
