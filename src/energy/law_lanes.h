/// Force law in SIMD lanes.
#pragma once

#include "energy/law_table.h"
#include "energy/packs.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

struct LawLanes {
  Lanes potential, force, slope;  ///< as Curve::Point
};

/// Truncates to integers. @pre they fit into an int
static HAPTIC_CLOTH_INLINE void truncate(const Lanes& v, int* whole) {
#if HAPTIC_CLOTH_LANES == 8 && defined(__AVX512F__)
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(whole), _mm512_cvttpd_epi32(__m512d(v)));
#elif HAPTIC_CLOTH_LANES == 4 && defined(__AVX__)
  _mm_storeu_si128(reinterpret_cast<__m128i*>(whole), _mm256_cvttpd_epi32(__m256d(v)));
#else
  for (int l = 0; l < kLanes; ++l) whole[l] = static_cast<int>(v[l]);
#endif
}

/// Coefficients of one interval for each lane.
static HAPTIC_CLOTH_INLINE void fetch(const LawInterval* intervals, const Lanes& which, Lanes& p, Lanes& q,
                                      Lanes& r) {
  int interval[kLanes];
  truncate(which, interval);
#if HAPTIC_CLOTH_LANES >= 4 && defined(__AVX__)
  // An interval is one load; four loads form a matrix that is transposed.
  __m256d parts[3][kLanes / 4];
  for (int l = 0; l < kLanes; l += 4) {
    const __m256d a = _mm256_load_pd(&intervals[interval[l]].p),
                  b = _mm256_load_pd(&intervals[interval[l + 1]].p),
                  c = _mm256_load_pd(&intervals[interval[l + 2]].p),
                  d = _mm256_load_pd(&intervals[interval[l + 3]].p);
    const __m256d low_ab = _mm256_unpacklo_pd(a, b), low_cd = _mm256_unpacklo_pd(c, d),
                  high_ab = _mm256_unpackhi_pd(a, b), high_cd = _mm256_unpackhi_pd(c, d);
    parts[0][l / 4] = _mm256_permute2f128_pd(low_ab, low_cd, 0x20);
    parts[1][l / 4] = _mm256_permute2f128_pd(high_ab, high_cd, 0x20);
    parts[2][l / 4] = _mm256_permute2f128_pd(low_ab, low_cd, 0x31);
  }
#if HAPTIC_CLOTH_LANES == 8
  p = join(parts[0][0], parts[0][1]);
  q = join(parts[1][0], parts[1][1]);
  r = join(parts[2][0], parts[2][1]);
#else
  p = Lanes(parts[0][0]);
  q = Lanes(parts[1][0]);
  r = Lanes(parts[2][0]);
#endif
#else
  for (int l = 0; l < kLanes; ++l) {
    const LawInterval& at = intervals[interval[l]];
    p[l] = at.p;
    q[l] = at.q;
    r[l] = at.r;
  }
#endif
}

/// Evaluates a law for the elements from `lane` on.
/// @param steps memory of their pack, not read if the law has none
static HAPTIC_CLOTH_INLINE LawLanes evaluate(const LawView& law, const Lanes& s, const StepPack* steps,
                                             int lane) {
  using Kind = LawView::Kind;
  if (law.kind == Kind::Line) {
    const LawInterval& only = law.intervals[0];
    return {only.p + s * (only.q + 0.5 * only.r * s), only.q + only.r * s, all(only.r)};
  }
  if (law.kind == Kind::TwoLines) {  // both lines pass through zero
    const Lanes slope = ifLess(s, Lanes{}, all(law.intervals[0].r), all(law.intervals[1].r));
    const Lanes force = slope * s;
    return {0.5 * force * s, force, slope};
  }
  const Lanes interval = smaller(larger((s - law.begin) * law.inverse_step, Lanes{}), all(law.last));
  Lanes p{}, q{}, r{};
  if (law.kind == Kind::Table) {
    fetch(law.intervals, interval, p, q, r);
    return {p + s * (q + 0.5 * r * s), q + r * s, r};
  }
  const Lanes high = load(steps->high + lane), low = load(steps->low + lane), one = all(1.0), none{};
  const Lanes upper = ifLess(high, s, one, none), lower = ifLess(s, low, one, none);
  fetch(law.intervals, interval + (law.last + 1.0) * (one - upper + lower), p, q, r);
  p += upper * load(steps->on_upper + lane) + lower * load(steps->on_lower + lane);
  q += (one - upper - lower) * load(steps->play + lane);
  return {p + s * (q + 0.5 * r * s), q + r * s, r};
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
