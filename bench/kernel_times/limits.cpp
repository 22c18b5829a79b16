#include "limits.h"

#include "parallel/lanes.h"

namespace haptic_cloth {
namespace {

constexpr double kFactor = 0.5;

HAPTIC_CLOTH_CLONES void triad(double* a, const double* b, const double* c, int count) {
  const Lanes factor = all(kFactor);
  for (int n = 0; n < count; n += kLanes) store(a + n, load(b + n) + factor * load(c + n));
}

/// Contracts to fused operations where the instruction set has them; so do the library's loops.
template <int Chains>
HAPTIC_CLOTH_INLINE double multiplyAdd(int rounds) {
  Lanes chain[Chains];
  for (int k = 0; k < Chains; ++k) chain[k] = all(2.0 + 0.01 * k);
  const Lanes factor = all(0.999), term = all(1e-3);  // to 1: neither grows nor becomes denormal
  for (int round = 0; round < rounds; ++round) {
#pragma GCC unroll 12
    for (int k = 0; k < Chains; ++k) chain[k] = chain[k] * factor + term;
  }
  Lanes sum{};
  for (int k = 0; k < Chains; ++k) sum += chain[k];
  return total(sum);
}

}  // namespace

HAPTIC_CLOTH_CLONES double multiplyAdd3(int rounds) { return multiplyAdd<3>(rounds); }
HAPTIC_CLOTH_CLONES double multiplyAdd6(int rounds) { return multiplyAdd<6>(rounds); }
HAPTIC_CLOTH_CLONES double multiplyAdd12(int rounds) { return multiplyAdd<12>(rounds); }

HAPTIC_CLOTH_CLONES double rootAndDivide(const double* values, int count) {
  Lanes sum{};
  for (int n = 0; n < count; n += kLanes) sum += 1.0 / squareRoot(load(values + n));
  return total(sum);
}

Triad::Triad(std::size_t bytes) {
  const int count = padded(static_cast<int>(bytes / (3 * sizeof(double))));
  for (auto* list : {&a_, &b_, &c_}) list->assign(count, 1.0);
}

void Triad::run() { triad(a_.data(), b_.data(), c_.data(), static_cast<int>(a_.size())); }

const char* instructionSet() {
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    __GNUC__ >= 12
  if (__builtin_cpu_supports("x86-64-v4")) return "x86-64-v4";
  if (__builtin_cpu_supports("x86-64-v3")) return "x86-64-v3";
#endif
  return "baseline";
}

}  // namespace haptic_cloth
