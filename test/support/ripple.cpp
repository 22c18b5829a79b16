#include "support/ripple.h"

#include <Eigen/Dense>
#include <cmath>

namespace haptic_cloth {

double ripple(const std::vector<double>& x, const std::vector<double>& y, int degree) {
  const auto count = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd powers(count, degree + 1);
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(y.data(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int p = 0; p <= degree; ++p) powers(k, p) = std::pow(x[static_cast<std::size_t>(k)], p);
  }
  const Eigen::VectorXd fit = powers * powers.colPivHouseholderQr().solve(values);
  return (values - fit).cwiseAbs().maxCoeff() / values.mean();
}

}  // namespace haptic_cloth
