/// Points of four doubles, x, y, z and a zero, between memory and registers of coordinates.
#pragma once

#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

#if HAPTIC_CLOTH_LANES >= 4 && defined(__AVX__)

using Point = double __attribute__((vector_size(4 * sizeof(double))));

static HAPTIC_CLOTH_INLINE Point loadPoint(const double* p) { return Point(_mm256_load_pd(p)); }

/// Rows of a 4 x 4 matrix become its columns.
static HAPTIC_CLOTH_INLINE void transpose(__m256d& a, __m256d& b, __m256d& c, __m256d& d) {
  const __m256d low_ab = _mm256_unpacklo_pd(a, b), high_ab = _mm256_unpackhi_pd(a, b),
                low_cd = _mm256_unpacklo_pd(c, d), high_cd = _mm256_unpackhi_pd(c, d);
  a = _mm256_permute2f128_pd(low_ab, low_cd, 0x20);
  b = _mm256_permute2f128_pd(high_ab, high_cd, 0x20);
  c = _mm256_permute2f128_pd(low_ab, low_cd, 0x31);
  d = _mm256_permute2f128_pd(high_ab, high_cd, 0x31);
}

static HAPTIC_CLOTH_INLINE void storeFour(double* points, __m256d x, __m256d y, __m256d z) {
  __m256d zero = _mm256_setzero_pd();
  transpose(x, y, z, zero);
  _mm256_store_pd(points, x);
  _mm256_store_pd(points + 4, y);
  _mm256_store_pd(points + 8, z);
  _mm256_store_pd(points + 12, zero);
}

/// Writes a register of points. @pre aligned to 32 bytes
static HAPTIC_CLOTH_INLINE void storePoints(double* points, const Lanes3& v) {
#if HAPTIC_CLOTH_LANES == 8
  const __m512d x = __m512d(v.x), y = __m512d(v.y), z = __m512d(v.z);
  storeFour(points, _mm512_castpd512_pd256(x), _mm512_castpd512_pd256(y), _mm512_castpd512_pd256(z));
  storeFour(points + 16, _mm512_extractf64x4_pd(x, 1), _mm512_extractf64x4_pd(y, 1),
            _mm512_extractf64x4_pd(z, 1));
#else
  storeFour(points, __m256d(v.x), __m256d(v.y), __m256d(v.z));
#endif
}

/// A register of points. @param points kLanes of them
static HAPTIC_CLOTH_INLINE Lanes3 coordinates(const Point* points) {
  __m256d a = __m256d(points[0]), b = __m256d(points[1]), c = __m256d(points[2]), d = __m256d(points[3]);
  transpose(a, b, c, d);
#if HAPTIC_CLOTH_LANES == 8
  __m256d e = __m256d(points[4]), f = __m256d(points[5]), g = __m256d(points[6]), h = __m256d(points[7]);
  transpose(e, f, g, h);
  return {join(a, e), join(b, f), join(c, g)};
#else
  return {Lanes(a), Lanes(b), Lanes(c)};
#endif
}

#else

struct Point {
  Lanes xy, z;
};
static_assert(kLanes == 2, "a point is two registers");

static HAPTIC_CLOTH_INLINE Point operator+(const Point& a, const Point& b) { return {a.xy + b.xy, a.z + b.z}; }
static HAPTIC_CLOTH_INLINE Point operator*(double s, const Point& a) { return {s * a.xy, s * a.z}; }

static HAPTIC_CLOTH_INLINE Point loadPoint(const double* p) { return {load(p), load(p + 2)}; }

static HAPTIC_CLOTH_INLINE void storePoints(double* points, const Lanes3& v) {
  for (int l = 0; l < kLanes; ++l) {
    store(points + 4 * l, Lanes{v.x[l], v.y[l]});
    store(points + 4 * l + 2, Lanes{v.z[l], 0.0});
  }
}

static HAPTIC_CLOTH_INLINE Lanes3 coordinates(const Point* points) {
  return {Lanes{points[0].xy[0], points[1].xy[0]}, Lanes{points[0].xy[1], points[1].xy[1]},
          Lanes{points[0].z[0], points[1].z[0]}};
}

#endif

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
