// Compiled with -O3 -march=native for the machine that builds it.
#include "plain_gradient.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

// Units: m, N/m, N m, N/m.
constexpr double kSpacing = 0.01, kMembrane = 1000.0, kBending = 1e-5, kShear = 30.0;

}  // namespace

PlainSheet::PlainSheet(int n) : n_(n), position_(n * n), normal_(n * n, {0.0, 0.0, 1.0}), gradient_(n * n) {
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      position_[j * n + i] = {i * kSpacing + 1e-5 * std::sin(3 * i + j),
                              j * kSpacing + 1e-5 * std::cos(i * j), 1e-4 * std::sin(i + 2 * j)};
    }
  }
}

/// An edge: A/2 E ε².
double PlainSheet::stretch(int a, int b) {
  const Vector span = minus(position_[b], position_[a]);
  const double length = std::sqrt(dot(span, span)), strain = length / kSpacing - 1.0;
  const double force = kSpacing * kMembrane * strain;
  add(b, force / length, span);
  add(a, -force / length, span);
  return 0.5 * kSpacing * force * strain;
}

/// Three particles in a row: A/2 B κ².
double PlainSheet::bend(int left, int centre, int right) {
  constexpr double kInverse = 1.0 / (kSpacing * kSpacing);
  const Vector& normal = normal_[centre];
  const Vector before = minus(position_[left], position_[centre]),
               after = minus(position_[right], position_[centre]);
  const double curvature = kInverse * (dot(normal, before) + dot(normal, after));
  const double moment = kSpacing * kSpacing * kBending * curvature;
  add(left, moment * kInverse, normal);
  add(right, moment * kInverse, normal);
  add(centre, -2.0 * moment * kInverse, normal);
  return 0.5 * moment * curvature;
}

/// A cell with corners a (i, j), b (i+1, j), c (i, j+1), d (i+1, j+1): A/2 G γ².
double PlainSheet::shear(int a, int b, int c, int d) {
  const Vector rising = minus(position_[d], position_[a]), falling = minus(position_[b], position_[c]);
  const Vector u{rising.x + falling.x, rising.y + falling.y, rising.z + falling.z},
      v = minus(rising, falling);
  const double uu = dot(u, u), vv = dot(v, v), product = dot(u, v);
  const double area = std::sqrt(uu * vv - product * product), angle = std::atan2(product, area);
  const double force = kSpacing * kSpacing * kShear * angle;
  const double uu_part = product / uu, vv_part = product / vv;
  const Vector du{(v.x - uu_part * u.x) / area, (v.y - uu_part * u.y) / area, (v.z - uu_part * u.z) / area};
  const Vector dv{(u.x - vv_part * v.x) / area, (u.y - vv_part * v.y) / area, (u.z - vv_part * v.z) / area};
  const Vector by_rising{du.x + dv.x, du.y + dv.y, du.z + dv.z}, by_falling = minus(du, dv);
  add(d, force, by_rising);
  add(a, -force, by_rising);
  add(b, force, by_falling);
  add(c, -force, by_falling);
  return 0.5 * force * angle;
}

double PlainSheet::gradient() {
  const int n = n_;
  double energy = 0.0;
  std::fill(gradient_.begin(), gradient_.end(), Vector{0.0, 0.0, 0.0});
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) energy += stretch(j * n + i, j * n + i + 1);
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i < n; ++i) energy += stretch(j * n + i, j * n + i + n);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 1; i + 1 < n; ++i) energy += bend(j * n + i - 1, j * n + i, j * n + i + 1);
  }
  for (int j = 1; j + 1 < n; ++j) {
    for (int i = 0; i < n; ++i) energy += bend(j * n + i - n, j * n + i, j * n + i + n);
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      energy += shear(j * n + i, j * n + i + 1, j * n + i + n, j * n + i + n + 1);
    }
  }
  return energy;
}

}  // namespace haptic_cloth
