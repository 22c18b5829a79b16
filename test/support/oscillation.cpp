#include "support/oscillation.h"

#include <Eigen/Dense>
#include <cmath>

namespace haptic_cloth {

Oscillation fitOscillation(const std::vector<double>& x, int first, int stride) {
  const int rows = static_cast<int>(x.size()) - first - 2 * stride;
  Eigen::MatrixXd a(rows, 3);
  Eigen::VectorXd b(rows);
  for (int n = 0; n < rows; ++n) {
    a.row(n) << x[first + n + stride], -x[first + n], 1.0;
    b[n] = x[first + n + 2 * stride];
  }
  const Eigen::VectorXd c = a.colPivHouseholderQr().solve(b);
  const double ratio = std::sqrt(c[1]);
  const double phase = std::acos(0.5 * c[0] / ratio);
  return {phase / stride, std::pow(ratio, 4.0 * static_cast<double>(EIGEN_PI) / phase)};
}

}  // namespace haptic_cloth
