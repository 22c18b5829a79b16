/// Vectors of as many doubles as a register of the instruction set holds. Only kernels include this
/// header. Their sources are compiled once for each instruction set, each time in a separate
/// namespace (HAPTIC_CLOTH_PATH) and with the width of that set (HAPTIC_CLOTH_LANES). The compiler
/// would split wider vectors, through memory.
///
/// Everything that a kernel calls must be inlined. The linker might take a function from another
/// kernel's object file, with instructions that the machine does not have.
#pragma once

#include <cmath>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "simd/pack.h"

#define HAPTIC_CLOTH_INLINE inline __attribute__((always_inline))

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

constexpr int kLanes = HAPTIC_CLOTH_LANES;
static_assert(kPack % kLanes == 0, "packs are whole registers");

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using Bits = unsigned long long __attribute__((vector_size(kLanes * sizeof(long long))));

static HAPTIC_CLOTH_INLINE Lanes load(const double* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

static HAPTIC_CLOTH_INLINE void store(double* p, const Lanes& v) { std::memcpy(p, &v, sizeof(v)); }

static HAPTIC_CLOTH_INLINE Lanes all(double value) { return Lanes{} + value; }

// Square roots; loads and stores in single precision, which is enough for values that control the
// solve.
#if HAPTIC_CLOTH_LANES == 8 && defined(__AVX512F__)
static HAPTIC_CLOTH_INLINE Lanes squareRoot(const Lanes& v) { return Lanes(_mm512_sqrt_pd(__m512d(v))); }
static HAPTIC_CLOTH_INLINE Lanes load(const float* p) { return Lanes(_mm512_cvtps_pd(_mm256_loadu_ps(p))); }
static HAPTIC_CLOTH_INLINE void store(float* p, const Lanes& v) {
  _mm256_storeu_ps(p, _mm512_cvtpd_ps(__m512d(v)));
}
#elif HAPTIC_CLOTH_LANES == 4 && defined(__AVX__)
static HAPTIC_CLOTH_INLINE Lanes squareRoot(const Lanes& v) { return Lanes(_mm256_sqrt_pd(__m256d(v))); }
static HAPTIC_CLOTH_INLINE Lanes load(const float* p) { return Lanes(_mm256_cvtps_pd(_mm_loadu_ps(p))); }
static HAPTIC_CLOTH_INLINE void store(float* p, const Lanes& v) {
  _mm_storeu_ps(p, _mm256_cvtpd_ps(__m256d(v)));
}
#elif HAPTIC_CLOTH_LANES == 2 && defined(__SSE2__)
static HAPTIC_CLOTH_INLINE Lanes squareRoot(const Lanes& v) { return Lanes(_mm_sqrt_pd(__m128d(v))); }
static HAPTIC_CLOTH_INLINE Lanes load(const float* p) {
  return Lanes(_mm_cvtps_pd(_mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(p)))));
}
static HAPTIC_CLOTH_INLINE void store(float* p, const Lanes& v) {
  _mm_store_sd(reinterpret_cast<double*>(p), _mm_castps_pd(_mm_cvtpd_ps(__m128d(v))));
}
#else
static HAPTIC_CLOTH_INLINE Lanes squareRoot(const Lanes& v) {
  Lanes r{};
  for (int l = 0; l < kLanes; ++l) r[l] = std::sqrt(v[l]);
  return r;
}
static HAPTIC_CLOTH_INLINE Lanes load(const float* p) {
  Lanes v{};
  for (int l = 0; l < kLanes; ++l) v[l] = static_cast<double>(p[l]);
  return v;
}
static HAPTIC_CLOTH_INLINE void store(float* p, const Lanes& v) {
  for (int l = 0; l < kLanes; ++l) p[l] = static_cast<float>(v[l]);
}
#endif

/// Selects x in the lanes where a < b, and y in the others, also if a or b is NaN.
static HAPTIC_CLOTH_INLINE Lanes ifLess(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y) {
  return a < b ? x : y;
}
static HAPTIC_CLOTH_INLINE Lanes ifPositive(const Lanes& a, const Lanes& x, const Lanes& y) {
  return ifLess(Lanes{}, a, x, y);
}

static HAPTIC_CLOTH_INLINE Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
static HAPTIC_CLOTH_INLINE Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }

/// Tells whether a < b in all lanes; false if a lane has a NaN.
static HAPTIC_CLOTH_INLINE bool allLess(const Lanes& a, const Lanes& b) {
#if HAPTIC_CLOTH_LANES == 8 && defined(__AVX512F__)
  return _mm512_cmp_pd_mask(__m512d(a), __m512d(b), _CMP_LT_OQ) == 0xff;
#elif HAPTIC_CLOTH_LANES == 4 && defined(__AVX__)
  return _mm256_movemask_pd(_mm256_cmp_pd(__m256d(a), __m256d(b), _CMP_LT_OQ)) == 0xf;
#elif HAPTIC_CLOTH_LANES == 2 && defined(__SSE2__)
  return _mm_movemask_pd(_mm_cmplt_pd(__m128d(a), __m128d(b))) == 0x3;
#else
  bool less = true;
  for (int l = 0; l < kLanes; ++l) less = less && a[l] < b[l];
  return less;
#endif
}

/// Smallest of the lanes.
static HAPTIC_CLOTH_INLINE double least(const Lanes& v) {
  double least = v[0];
  for (int l = 1; l < kLanes; ++l) least = v[l] < least ? v[l] : least;
  return least;
}

/// Sum of the lanes, in a fixed order.
static HAPTIC_CLOTH_INLINE double total(const Lanes& v) {
  double sum[kLanes];
  for (int l = 0; l < kLanes; ++l) sum[l] = v[l];
  for (int width = kLanes / 2; width > 0; width /= 2) {
    for (int l = 0; l < width; ++l) sum[l] += sum[l + width];
  }
  return sum[0];
}

/// Natural logarithm, to about one unit in the last place [fdlibm, e_log.c]. @pre normal and
/// positive
static HAPTIC_CLOTH_INLINE Lanes logarithm(const Lanes& x) {
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  constexpr double kFit[] = {6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                             2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                             1.479819860511658591e-01};
  const Bits bits = Bits(x), magic = Bits{} + 0x4330000000000000ull;  // 2⁵²: integers in its last bits
  const Lanes biased = Lanes((bits >> 52) | magic) - 4503599627370496.0;
  const Lanes mantissa = Lanes((bits & (Bits{} + 0x000fffffffffffffull)) | (Bits{} + 0x3ff0000000000000ull));
  const Lanes limit = all(1.4142135623730951), half = all(0.5), one = all(1.0);
  const Lanes k = biased - 1023.0 + ifLess(limit, mantissa, one, Lanes{});
  const Lanes f = mantissa * ifLess(limit, mantissa, half, one) - 1.0;
  const Lanes s = f / (2.0 + f), z = s * s, square = 0.5 * f * f;
  Lanes fit = all(kFit[6]);
  for (int j = 5; j >= 0; --j) fit = fit * z + kFit[j];
  return k * kLn2High - ((square - (s * (square + z * fit) + k * kLn2Low)) - f);
}

/// One point or vector for each lane.
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

static HAPTIC_CLOTH_INLINE Lanes3 load(const ConstArrays& arrays, int first) {
  return {load(arrays.x + first), load(arrays.y + first), load(arrays.z + first)};
}
static HAPTIC_CLOTH_INLINE void store(const MutableArrays& arrays, int first, const Lanes3& v) {
  store(arrays.x + first, v.x);
  store(arrays.y + first, v.y);
  store(arrays.z + first, v.z);
}

/// Vectors of lanes l and following of a pack, coordinate by coordinate.
static HAPTIC_CLOTH_INLINE Lanes3 load3(const double (*values)[kPack], int l) {
  return {load(values[0] + l), load(values[1] + l), load(values[2] + l)};
}
static HAPTIC_CLOTH_INLINE void store3(double (*values)[kPack], int l, const Lanes3& v) {
  store(values[0] + l, v.x);
  store(values[1] + l, v.y);
  store(values[2] + l, v.z);
}

/// Tells whether kLanes indices from `lane` on are consecutive.
static HAPTIC_CLOTH_INLINE bool inRow(const PackIndices& at, int lane) {
  constexpr unsigned kRow = (1u << (kLanes - 1)) - 1;
  return ((at.rows >> lane) & kRow) == kRow;
}

#if HAPTIC_CLOTH_LANES == 8 && defined(__AVX512F__)
/// Loads four values, in one load if they are consecutive.
static HAPTIC_CLOTH_INLINE __m256d four(const double* values, const int* index, bool row) {
  if (row) return _mm256_loadu_pd(values + index[0]);
  return _mm256_set_pd(values[index[3]], values[index[2]], values[index[1]], values[index[0]]);
}
static HAPTIC_CLOTH_INLINE Lanes join(const __m256d& low, const __m256d& high) {
  return Lanes(_mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1));
}
static HAPTIC_CLOTH_INLINE Lanes pick(const double* values, const PackIndices& at, int) {
  return join(four(values, at.index, (at.rows & 7u) == 7u),
              four(values, at.index + 4, (at.rows >> 4 & 7u) == 7u));
}
#elif HAPTIC_CLOTH_LANES == 4 && defined(__AVX__)
static HAPTIC_CLOTH_INLINE Lanes pick(const double* values, const PackIndices& at, int lane) {
  const int* const index = at.index + lane;
  return Lanes(_mm256_set_pd(values[index[3]], values[index[2]], values[index[1]], values[index[0]]));
}
#else
static HAPTIC_CLOTH_INLINE Lanes pick(const double* values, const PackIndices& at, int lane) {
  Lanes v{};
  for (int l = 0; l < kLanes; ++l) v[l] = values[at.index[lane + l]];
  return v;
}
#endif

/// Values at kLanes indices from `lane` on.
static HAPTIC_CLOTH_INLINE Lanes gather(const double* values, const PackIndices& at, int lane) {
  return inRow(at, lane) ? load(values + at.index[lane]) : pick(values, at, lane);
}
static HAPTIC_CLOTH_INLINE Lanes3 gather(const ConstArrays& values, const PackIndices& at, int lane) {
  if (inRow(at, lane)) return load(values, at.index[lane]);
  return {pick(values.x, at, lane), pick(values.y, at, lane), pick(values.z, at, lane)};
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
