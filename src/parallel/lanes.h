/// Eight numbers at a time: the compiler's vector extension, and functions compiled for several instruction
/// sets of which the machine's best is taken when the program is loaded.
#pragma once

#include <cmath>
#include <cstring>

/// On a function with loops over Lanes. Everything it calls must be HAPTIC_CLOTH_INLINE.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    __GNUC__ >= 12
#define HAPTIC_CLOTH_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HAPTIC_CLOTH_CLONES
#endif
#define HAPTIC_CLOTH_INLINE inline __attribute__((always_inline))

namespace haptic_cloth {

constexpr int kLanes = 8;

/// Smallest multiple of kLanes that holds n.
constexpr int padded(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using Integers = long long __attribute__((vector_size(kLanes * sizeof(long long))));

static HAPTIC_CLOTH_INLINE Lanes load(const double* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

static HAPTIC_CLOTH_INLINE void store(double* p, const Lanes& v) { std::memcpy(p, &v, sizeof(v)); }

static HAPTIC_CLOTH_INLINE Lanes all(double value) { return Lanes{} + value; }

static HAPTIC_CLOTH_INLINE Lanes squareRoot(const Lanes& v) {
  Lanes r;
  for (int l = 0; l < kLanes; ++l) r[l] = std::sqrt(v[l]);
  return r;
}

/// x in the lanes where a < b, y in the others, by the sign of a - b. Where the extension's own comparisons
/// are combined, or lanes are wider than the machine's, gcc makes them one by one, at ten times the cost.
/// @pre a - b is a number; where it may not be and decides about memory, larger() and smaller() are safe
static HAPTIC_CLOTH_INLINE Lanes ifLess(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y) {
  using Bits = unsigned long long __attribute__((vector_size(sizeof(Lanes))));
  const Bits less = Bits{} - (Bits(a - b + 0.0) >> 63);  // + 0.0: -0 is not less than 0
  return Lanes((Bits(x) & less) | (Bits(y) & ~less));
}
static HAPTIC_CLOTH_INLINE Lanes ifPositive(const Lanes& a, const Lanes& x, const Lanes& y) {
  return ifLess(Lanes{}, a, x, y);
}

static HAPTIC_CLOTH_INLINE Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
static HAPTIC_CLOTH_INLINE Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }

/// Largest of the lanes.
static HAPTIC_CLOTH_INLINE double greatest(const Lanes& v) {
  const auto larger_of = [](double a, double b) { return a > b ? a : b; };
  return larger_of(larger_of(larger_of(v[0], v[1]), larger_of(v[2], v[3])),
                   larger_of(larger_of(v[4], v[5]), larger_of(v[6], v[7])));
}

/// Sum of the lanes, in a fixed order.
static HAPTIC_CLOTH_INLINE double total(const Lanes& v) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

/// Three lanes make eight points or vectors.
struct Lanes3 {
  Lanes x, y, z;
};

static HAPTIC_CLOTH_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
static HAPTIC_CLOTH_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
static HAPTIC_CLOTH_INLINE Lanes3 operator*(const Lanes& s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
static HAPTIC_CLOTH_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace haptic_cloth
