#include "support/derivatives.h"

#include <algorithm>
#include <random>

namespace haptic_cloth {

using Eigen::VectorXd;

VectorXd differenceGradient(const Potential& potential, const VectorXd& x, double step) {
  VectorXd gradient(x.size());
  VectorXd y = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    y[k] = x[k] + step;
    const double above = potential(y);
    y[k] = x[k] - step;
    const double below = potential(y);
    y[k] = x[k];
    gradient[k] = (above - below) / (2.0 * step);
  }
  return gradient;
}

double gradientError(const Potential& potential, const Gradient& gradient, const VectorXd& x, double step,
                     double floor) {
  const VectorXd exact = gradient(x);
  const VectorXd difference = differenceGradient(potential, x, step);
  return (exact - difference).lpNorm<Eigen::Infinity>() / std::max(exact.lpNorm<Eigen::Infinity>(), floor);
}

double differenceQuadraticForm(const Gradient& gradient, const VectorXd& x, const VectorXd& d, double step) {
  return d.dot(gradient(x + step * d) - gradient(x - step * d)) / (2.0 * step);
}

VectorXd fixedRandom(int size, unsigned seed) {
  std::mt19937 bits(seed);  // the standard fixes its sequence, but not those of the distributions
  VectorXd values(size);
  for (double& value : values) value = 2.0 * (bits() / 4294967295.0) - 1.0;
  return values;
}

}  // namespace haptic_cloth
