#include "support/buckling_solutions.h"

#include <cmath>
#include <functional>

namespace haptic_cloth {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Root of a function that rises through zero between low and high.
double bisect(double low, double high, const std::function<double(double)>& f) {
  for (int k = 0; k < 200 && high - low > 1e-15 * std::abs(high); ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// State of the column at u, the distance from the tip in units of c.
struct ColumnState {
  double theta, slope, height, deflection;
};

ColumnState operator+(const ColumnState& a, const ColumnState& b) {
  return {a.theta + b.theta, a.slope + b.slope, a.height + b.height, a.deflection + b.deflection};
}

ColumnState operator*(double f, const ColumnState& a) {
  return {f * a.theta, f * a.slope, f * a.height, f * a.deflection};
}

/// Integrates from the tip back to the foot.
ColumnState integrate(double tip_angle, double lambda, double tilt) {
  const auto rate = [tilt](double u, const ColumnState& a) {
    return ColumnState{a.slope, -u * std::sin(a.theta + tilt), std::cos(a.theta), std::sin(a.theta)};
  };
  constexpr int kSteps = 2000;
  const double h = lambda / kSteps;
  ColumnState a{tip_angle, 0.0, 0.0, 0.0};
  for (int k = 0; k < kSteps; ++k) {
    const double u = k * h;
    const ColumnState k1 = rate(u, a);
    const ColumnState k2 = rate(u + 0.5 * h, a + 0.5 * h * k1);
    const ColumnState k3 = rate(u + 0.5 * h, a + 0.5 * h * k2);
    const ColumnState k4 = rate(u + h, a + h * k3);
    a = a + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return a;
}

/// Sums cₙ with c₀ = 1 and cₙ₊₁ = -cₙ x / ((p n + p)(p n + p - 1)): f(1) of f'' = -x z^(p-2) f,
/// f(0) = 1, f'(0) = 0.
double series(double x, int power) {
  double term = 1.0, sum = 1.0;
  for (int n = 1; n < 60; ++n) {
    term *= -x / (power * n * (power * n - 1.0));
    sum += term;
  }
  return sum;
}

}  // namespace

HeavyColumn heavyColumn(double lambda, double tilt) {
  const double tip =
      bisect(0.0, kPi - tilt, [=](double angle) { return integrate(angle, lambda, tilt).theta; });
  const ColumnState foot = integrate(tip, lambda, tilt);
  return {tip, foot.height / lambda, foot.deflection / lambda};
}

double criticalColumn() {
  return bisect(1.5, 2.5, [](double lambda) { return -series(std::pow(lambda, 3), 3); });
}

PostBuckled postBuckled(double shortening) {
  const double k = bisect(0.0, 1.0, [=](double modulus) {
    return 2.0 - 2.0 * std::comp_ellint_2(modulus) / std::comp_ellint_1(modulus) - shortening;
  });
  const double quarter = std::comp_ellint_1(k);
  const double load = std::pow(2.0 * quarter / kPi, 2);
  // ½Bκ² = P (cos θ - cos α) along the strip, and cos α = 1 - 2k².
  return {load, k / quarter, load * (2.0 * k * k - shortening)};
}

double lateralStiffness(double gamma) { return series(0.25 * gamma * gamma, 6); }

double criticalLateral() {
  return bisect(5.0, 20.0, [](double gamma) { return -lateralStiffness(gamma); });
}

}  // namespace haptic_cloth
