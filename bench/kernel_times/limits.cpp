// Plain loops that the compiler may optimise fully: this file is compiled for the machine that
// builds it.
#include "limits.h"

#include <cmath>

namespace haptic_cloth {
namespace {

constexpr double kFactor = 0.5;

/// Iterates numbers that depend only on their own past, as many as fit into some registers.
template <int Count>
double multiplyAdd(int rounds) {
  double chain[Count];
  for (int k = 0; k < Count; ++k) chain[k] = 2.0 + 0.01 * k;
  for (int round = 0; round < rounds; ++round) {
#pragma GCC unroll 128
    // Tends to 1, so never denormal.
    for (int k = 0; k < Count; ++k) chain[k] = chain[k] * 0.999 + 1e-3;
  }
  double sum = 0.0;
  for (int k = 0; k < Count; ++k) sum += chain[k];
  return sum;
}

}  // namespace

double multiplyAdd24(int rounds) { return multiplyAdd<24>(rounds); }
double multiplyAdd48(int rounds) { return multiplyAdd<48>(rounds); }
double multiplyAdd96(int rounds) { return multiplyAdd<96>(rounds); }

double rootAndDivide(const double* values, int count) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (int n = 0; n < count; ++n) sum += 1.0 / std::sqrt(values[n]);
  return sum;
}

Triad::Triad(std::size_t bytes) {
  for (auto* list : {&a_, &b_, &c_}) list->assign(bytes / (3 * sizeof(double)), 1.0);
}

void Triad::run() {
  double* const a = a_.data();
  const double *const b = b_.data(), *const c = c_.data();
  const int count = static_cast<int>(a_.size());
#pragma omp simd
  for (int n = 0; n < count; ++n) a[n] = b[n] + kFactor * c[n];
}

}  // namespace haptic_cloth
