#include "support/elastica_solutions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

namespace haptic_cloth {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Section of a strip: θ is its angle above the horizontal, κ = dθ/ds.
struct Section {
  double s, theta, curvature, x, y, bending;
};

/// Force of the part beyond a section on the part before it: (x, y) at s = 0; y grows by `weight` · s.
struct Force {
  double x, y, weight;
};

/// Integrates θ'' = n_x sin θ - n_y cos θ to s = `end` with RK4. @param look  at each section
Section integrate(Section a, double end, const Force& force,
                  const std::function<void(const Section&)>& look = {}) {
  const auto rate = [&](const Section& b) {
    const double c = std::cos(b.theta), s = std::sin(b.theta);
    return Section{1.0, b.curvature, force.x * s - (force.y + force.weight * b.s) * c,
                   c,   s,           0.5 * b.curvature * b.curvature};
  };
  const auto moved = [](const Section& b, double f, const Section& r) {
    return Section{b.s + f * r.s, b.theta + f * r.theta, b.curvature + f * r.curvature,
                   b.x + f * r.x, b.y + f * r.y,         b.bending + f * r.bending};
  };
  constexpr int kSteps = 1000;
  const double h = (end - a.s) / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const Section k1 = rate(a), k2 = rate(moved(a, 0.5 * h, k1)), k3 = rate(moved(a, 0.5 * h, k2)),
                  k4 = rate(moved(a, h, k3));
    a = moved(moved(moved(moved(a, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
    if (look) look(a);
  }
  return a;
}

using Vector = Eigen::VectorXd;

/// Root of f near u, by Newton's method with central differences.
Vector root(Vector u, const std::function<Vector(const Vector&)>& f) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Vector value = f(u);
    if (value.norm() < 1e-12) break;
    Eigen::MatrixXd slope(u.size(), u.size());
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      Vector step = Vector::Zero(u.size());
      step[k] = 1e-5 * std::max(1.0, std::abs(u[k]));
      slope.col(k) = (f(u + step) - f(u - step)) / (2.0 * step[k]);
    }
    u -= slope.partialPivLu().solve(value);
  }
  return u;
}

}  // namespace

double frictionToStand(double lowering) {
  // Unknowns: curvature at the clamp, horizontal and vertical force of the floor.
  const auto tipOf = [](const Vector& u) {
    return integrate({0.0, -0.5 * kPi, u[0], 0.0, 0.0, 0.0}, 1.0, {u[1], u[2], 0.0});
  };
  // A small deflection is h (1 - s - cos ks + sin(ks)/k) with tan k = k, and lowers the clamp by the
  // mean of half its squared slope.
  const double k = 4.493409457909064, least = 0.002;
  double mean = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double s = (n + 0.5) / 1000.0;
    mean += 0.5e-3 * std::pow(-1.0 + k * std::sin(k * s) + std::cos(k * s), 2);
  }
  const double h = std::sqrt(least / mean);
  Vector u = h * k * k * Eigen::Vector3d(1.0, 1.0, 1.0 / h);
  constexpr int kParts = 20;
  for (int n = 0; n <= kParts; ++n) {
    const double down = least * std::pow(lowering / least, static_cast<double>(n) / kParts);
    u = root(u, [&](const Vector& v) -> Vector {
      const Section tip = tipOf(v);
      return Eigen::Vector3d(tip.curvature, tip.x, tip.y + 1.0 - down);
    });
  }
  return u[1] / u[2];
}

HangingLoop hangingLoop(const LoopClamps& clamps, double gamma, double thickness) {
  // Half of the loop, which turns to -π in the middle. There the vertical force vanishes by symmetry.
  const auto start = [&](double angle, double curvature) {
    return Section{0.0, angle, curvature, 0.5 * clamps.apart, 0.0, 0.0};
  };
  const auto force = [](double across, double weight) { return Force{across, -0.5 * weight, weight}; };
  HangingLoop loop{};
  const auto measure = [&](const Section& a) { loop.width = std::max(loop.width, 2.0 * a.x); };
  // Unknowns: curvature at the clamp, horizontal force; if the sides touch, also where, and the force
  // beyond. Clamps and weight come step by step, from the circle.
  Vector open = Eigen::Vector2d(-2.0 * kPi, 0.0), closed;
  constexpr int kParts = 40;
  for (int n = 1; n <= kParts; ++n) {
    const double angle = clamps.angle * n / kParts, weight = gamma * n / kParts;
    if (closed.size() == 0) {
      open = root(open, [&](const Vector& u) -> Vector {
        const Section middle = integrate(start(angle, u[0]), 0.5, force(u[1], weight));
        return Eigen::Vector2d(middle.theta + kPi, middle.x);
      });
      Section neck = start(angle, open[0]);
      integrate(neck, 0.25, force(open[1], weight),
                [&](const Section& a) { neck = a.x < neck.x ? a : neck; });
      if (2.0 * neck.x >= thickness) continue;
      closed = Eigen::Vector4d(open[0], open[1], neck.s, open[1]);
    }
    closed = root(closed, [&](const Vector& u) -> Vector {
      const Section neck = integrate(start(angle, u[0]), u[2], force(u[1], weight));
      const Section middle = integrate(neck, 0.5, force(u[3], weight));
      return Eigen::Vector4d(neck.x - 0.5 * thickness, neck.theta + 0.5 * kPi, middle.theta + kPi, middle.x);
    });
  }
  Section middle;
  if (closed.size() == 0) {
    middle = integrate(start(clamps.angle, open[0]), 0.5, force(open[1], gamma), measure);
    loop.moment = open[0];
  } else {
    const Section neck =
        integrate(start(clamps.angle, closed[0]), closed[2], force(closed[1], gamma), measure);
    middle = integrate(neck, 0.5, force(closed[3], gamma), measure);
    loop.moment = closed[0];
    loop.force = closed[1] - closed[3];
  }
  loop.height = -middle.y;
  loop.bending = 2.0 * middle.bending;
  return loop;
}

}  // namespace haptic_cloth
