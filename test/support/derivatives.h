/// Derivative check for any potential: force is the derivative of energy, stiffness that of force.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace haptic_cloth {

using Potential = std::function<double(const Eigen::VectorXd&)>;
using Gradient = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Gradient by central differences.
/// @param step step of each coordinate; the error is O(step²) plus O(round-off of the potential /
/// step)
Eigen::VectorXd differenceGradient(const Potential& potential, const Eigen::VectorXd& x, double step);

/// |gradient(x) - differenceGradient| / max(|gradient(x)|, floor), in the maximum norm.
double gradientError(const Potential& potential, const Gradient& gradient, const Eigen::VectorXd& x,
                     double step, double floor = 1e-12);

/// Quadratic form d · H d by central differences of the gradient along d.
double differenceQuadraticForm(const Gradient& gradient, const Eigen::VectorXd& x, const Eigen::VectorXd& d,
                               double step);

/// Uniform random numbers in [-1, 1], equal for equal seeds on every machine.
Eigen::VectorXd fixedRandom(int size, unsigned seed);

}  // namespace haptic_cloth
