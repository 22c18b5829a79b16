#include "support/dynamic_solutions.h"

#include <array>
#include <cmath>
#include <complex>
#include <utility>

namespace haptic_cloth {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Root between low and high, where f has opposite signs.
double root(double low, double high, const std::function<double(double)>& f) {
  const bool rises = f(low) < 0.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0.0) == rises ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// First sign change of f from `start` on, searched in steps of `step`, then refined.
double nextRoot(double start, double step, const std::function<double(double)>& f) {
  double before = f(start);
  for (double x = start + step;; x += step) {
    const double now = f(x);
    if ((now < 0.0) != (before < 0.0)) return root(x - step, x, f);
    before = now;
  }
}

template <std::size_t N>
using State = std::array<double, N>;

template <std::size_t N, class Rate>
State<N> rungeKutta(double s, double h, const State<N>& a, const Rate& rate) {
  const auto moved = [&](double f, const State<N>& k) {
    State<N> b = a;
    for (std::size_t i = 0; i < N; ++i) b[i] += f * k[i];
    return b;
  };
  const State<N> k1 = rate(s, a), k2 = rate(s + 0.5 * h, moved(0.5 * h, k1)),
                 k3 = rate(s + 0.5 * h, moved(0.5 * h, k2)), k4 = rate(s + h, moved(h, k3));
  State<N> b = a;
  for (std::size_t i = 0; i < N; ++i) b[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  return b;
}

/// y, y', y'', y''' of a hanging strip at 0, 1/n ... 1 from its tip, which starts with y and y'.
std::vector<State<4>> swing(double gamma, double frequency, double y, double slope, int n) {
  const auto rate = [&](double s, const State<4>& a) {
    return State<4>{a[1], a[2], a[3], gamma * (s * a[2] + a[1] + frequency * frequency * a[0])};
  };
  std::vector<State<4>> states{{y, slope, 0.0, 0.0}};
  for (int k = 0; k < n; ++k) {
    states.push_back(rungeKutta(static_cast<double>(k) / n, 1.0 / n, states.back(), rate));
  }
  return states;
}

}  // namespace

HangingMode hangingChainMode(int number, int intervals) {
  const auto top = [](double frequency) { return std::cyl_bessel_j(0.0, 2.0 * frequency); };
  HangingMode mode{0.0, {}};
  for (int k = 0; k < number; ++k) mode.frequency = nextRoot(mode.frequency + 0.01, 0.1, top);
  for (int k = 0; k <= intervals; ++k) {
    const double s = static_cast<double>(k) / intervals;
    mode.shape.push_back(std::cyl_bessel_j(0.0, 2.0 * mode.frequency * std::sqrt(s)));
  }
  return mode;
}

HangingMode hangingStripMode(double gamma, int number, int intervals) {
  const int refined = intervals * (2000 / intervals + 1);
  const auto ends = [&](double frequency) {
    return std::pair(swing(gamma, frequency, 1.0, 0.0, refined), swing(gamma, frequency, 0.0, 1.0, refined));
  };
  // A combination of the two solutions has y = y' = 0 at the top.
  const auto determinant = [&](double frequency) {
    const auto [a, b] = ends(frequency);
    return a.back()[0] * b.back()[1] - a.back()[1] * b.back()[0];
  };
  HangingMode mode{0.0, {}};
  for (int k = 0; k < number; ++k) mode.frequency = nextRoot(mode.frequency + 0.01, 0.2, determinant);
  const auto [a, b] = ends(mode.frequency);
  const double share = -a.back()[0] / b.back()[0];
  for (int k = 0; k <= intervals; ++k) {
    const int place = k * (refined / intervals);
    mode.shape.push_back(a[place][0] + share * b[place][0]);
  }
  return mode;
}

double backwardEulerPhase(double omega_h) { return std::atan(omega_h); }

double backwardEulerEnergy(double omega_h) {
  return std::pow(1.0 + omega_h * omega_h, -2.0 * kPi / backwardEulerPhase(omega_h));
}

namespace {

std::complex<double> bdf2Pole(double omega_h) {
  const std::complex<double> i(0.0, 1.0);
  return (2.0 + std::sqrt(1.0 + 2.0 * i * omega_h)) / (3.0 - 2.0 * i * omega_h);
}

}  // namespace

double bdf2Phase(double omega_h) { return std::arg(bdf2Pole(omega_h)); }

double bdf2Frequency(double phase) {
  return root(0.0, 1.0, [phase](double omega_h) { return bdf2Phase(omega_h) - phase; });
}

double bdf2Energy(double omega_h) {
  return std::pow(std::abs(bdf2Pole(omega_h)), 4.0 * kPi / bdf2Phase(omega_h));
}

DroopedTip droopedStrip(double length, double weight, const std::function<double(double)>& curvature) {
  constexpr int kSteps = 4000;
  // State from the tip: θ, moment, x, drop over u, the distance from the tip.
  const auto rate = [&](double u, const State<4>& a) {
    return State<4>{-curvature(a[1]), weight * u * std::cos(a[0]), std::cos(a[0]), std::sin(a[0])};
  };
  const auto clamp = [&](double tip) {
    State<4> a{tip, 0.0, 0.0, 0.0};
    for (int k = 0; k < kSteps; ++k) a = rungeKutta(k * length / kSteps, length / kSteps, a, rate);
    return a;
  };
  const State<4> end = clamp(nextRoot(0.0, 0.05, [&](double tip) { return clamp(tip)[0]; }));
  return {end[2], end[3]};
}

namespace {

/// θ, κ, x, drop, integrated back from the tip.
using Bent = State<4>;

/// Heavy elastica from its tip to the edge; -κ' = dκ/du = cos θ · u, with the weight u beyond.
Bent outside(double tip, double overhang) {
  constexpr int kSteps = 2000;
  const auto rate = [](double u, const Bent& a) {
    return Bent{-a[1], u * std::cos(a[0]), std::cos(a[0]), std::sin(a[0])};
  };
  Bent a{tip, 0.0, 0.0, 0.0};
  for (int k = 0; k < kSteps; ++k) a = rungeKutta(k * overhang / kSteps, overhang / kSteps, a, rate);
  return a;
}

/// Integrates from the edge back over the hump to where the strip touches the table again without
/// moment. The edge pushes at right angles to the strip, so the tension along it is continuous; its
/// horizontal part, equal to the drop of the tip, holds the strip.
std::pair<Bent, double> inside(const Bent& edge, double overhang) {
  constexpr double kStep = 2e-3, kFarthest = 6.0;
  const double hold = edge[3], along = overhang * std::sin(edge[0]);
  const double down = (along - hold * std::cos(edge[0])) / std::sin(edge[0]);
  const auto rate = [&](double u, const Bent& a) {
    // Force of the outer part on the inner: `hold` outwards, down + u downwards.
    return Bent{-a[1], (down + u) * std::cos(a[0]) - hold * std::sin(a[0]), std::cos(a[0]), std::sin(a[0])};
  };
  Bent a{edge[0], edge[1], 0.0, 0.0};
  double u = 0.0;
  while (u < kFarthest) {
    const Bent next = rungeKutta(u, kStep, a, rate);
    if (a[1] < 0.0 && next[1] >= 0.0) {
      const double part = a[1] / (a[1] - next[1]) * kStep;
      return {rungeKutta(u, part, a, rate), u + part};
    }
    a = next;
    u += kStep;
  }
  return {a, u};
}

}  // namespace

OverEdge stripOverEdge(double overhang) {
  // A tip as low as that of a clamped strip leaves the edge level, which no table can hold. The
  // search goes on to lower tips until the strip lies flat where its moment ends.
  const double clamped = nextRoot(0.0, 0.05, [&](double tip) { return outside(tip, overhang)[0]; });
  const double tip = nextRoot(clamped + 0.01, 0.001,
                              [&](double t) { return inside(outside(t, overhang), overhang).first[0]; });
  const Bent edge = outside(tip, overhang);
  return {inside(edge, overhang).second, tip, edge[3]};
}

double heldOverhang(double flat, double radius, double friction) {
  constexpr int kSteps = 1000;
  const double h = 0.5 * kPi / kSteps;
  const auto rate = [&](double angle, const State<1>& tension) {
    return State<1>{friction * (tension[0] + radius * std::cos(angle)) - radius * std::sin(angle)};
  };
  State<1> tension{friction * flat};
  for (int k = 0; k < kSteps; ++k) tension = rungeKutta(k * h, h, tension, rate);
  return tension[0];
}

}  // namespace haptic_cloth
