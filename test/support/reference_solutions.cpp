#include "support/reference_solutions.h"

#include <cmath>

namespace haptic_cloth {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Root of a function that rises through zero between low and high.
double bisect(double low, double high, const std::function<double(double)>& f) {
  for (int k = 0; k < 200 && high - low > 1e-16 * std::abs(high); ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// State of the elastica at u, the distance from the tip in units of c.
struct ElasticaState {
  double theta, slope, x, drop;
};

ElasticaState operator+(const ElasticaState& a, const ElasticaState& b) {
  return {a.theta + b.theta, a.slope + b.slope, a.x + b.x, a.drop + b.drop};
}

ElasticaState operator*(double f, const ElasticaState& a) {
  return {f * a.theta, f * a.slope, f * a.x, f * a.drop};
}

ElasticaState rate(double u, const ElasticaState& a) {
  return {a.slope, -u * std::cos(a.theta), std::cos(a.theta), std::sin(a.theta)};
}

/// Integrates from the tip back to the clamp.
ElasticaState integrate(double tip_angle, double lambda) {
  constexpr int kSteps = 2000;
  const double h = lambda / kSteps;
  ElasticaState a{tip_angle, 0.0, 0.0, 0.0};
  for (int k = 0; k < kSteps; ++k) {
    const double u = k * h;
    const ElasticaState k1 = rate(u, a);
    const ElasticaState k2 = rate(u + 0.5 * h, a + 0.5 * h * k1);
    const ElasticaState k3 = rate(u + 0.5 * h, a + 0.5 * h * k2);
    const ElasticaState k4 = rate(u + h, a + h * k3);
    a = a + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return a;
}

}  // namespace

Cantilever heavyElastica(double lambda) {
  const double tip =
      bisect(0.0, 0.5 * kPi, [lambda](double angle) { return integrate(angle, lambda).theta; });
  const ElasticaState root = integrate(tip, lambda);
  return {tip, root.x / lambda, root.drop / lambda, -root.slope};
}

Catenary catenary(double length) {
  // q is half the span over the parameter a of the catenary: sinh(q)/q = length.
  const double q = bisect(1e-9, 50.0, [length](double p) { return std::sinh(p) / p - length; });
  const double a = 0.5 / q;
  return {a * (std::cosh(q) - 1.0), a / length, a * std::cosh(q) / length};
}

Catenary elasticCatenary(double length, double stiffness) {
  // The weight is 1, and half of it hangs on each side. H rises until the two halves meet over the
  // span.
  const auto span = [&](double h) { return length * (h / stiffness + 2.0 * h * std::asinh(0.5 / h)); };
  const double h = bisect(1e-12, 2.0 * stiffness, [&](double p) { return span(p) - 1.0; });
  const double largest = std::hypot(h, 0.5);
  const double sag = length * (0.125 / stiffness + (largest - h));
  return {sag, h, largest};
}

double hangingExtension(double weight, double length, const std::function<double(double)>& strain) {
  constexpr int kIntervals = 2000;
  const double step = length / kIntervals;
  double sum = 0.0;
  for (int k = 0; k <= kIntervals; ++k) {
    const double factor = k == 0 || k == kIntervals ? 1.0 : (k % 2 == 1 ? 4.0 : 2.0);
    sum += factor * strain(weight * k * step);
  }
  return sum * step / 3.0;
}

double backwardEulerFall(double gravity, double time_step, int steps) {
  return 0.5 * gravity * time_step * time_step * steps * (steps + 1.0);
}

double bdf2Fall(double gravity, double time_step, int steps) {
  const double unit = gravity * time_step * time_step;
  double before = 0.0, now = unit;
  for (int n = 2; n <= steps; ++n) {
    const double next = (4.0 * now - before + 2.0 * unit * n) / 3.0;
    before = now;
    now = next;
  }
  return now;
}

}  // namespace haptic_cloth
