/// A force law for eight elements at a time.
#pragma once

#include <vector>

#include "haptic_cloth/loop.h"
#include "parallel/lanes.h"

namespace haptic_cloth {

/// Memory of eight elements, Loop::Step by Loop::Step.
struct StepLanes {
  double play[kLanes], low[kLanes], high[kLanes], on_lower[kLanes], on_upper[kLanes];

  Loop::Step get(int l) const { return {play[l], low[l], high[l], on_lower[l], on_upper[l]}; }
  void set(int l, const Loop::Step& step) {
    play[l] = step.play;
    low[l] = step.low;
    high[l] = step.high;
    on_lower[l] = step.on_lower;
    on_upper[l] = step.on_upper;
  }
};

struct LawLanes {
  Lanes potential, force, slope;  ///< as Curve::Point
};

/// Loop's curves as polynomials ψ = p + s (q + ½ r s), f = q + r s on equal intervals, those of the upper
/// branch, the path and the lower branch one after the other.
class LawTable {
 public:
  explicit LawTable(const Loop& law);

  bool hasMemory() const { return memory_; }

  /// @param steps memory of these elements; not read where the law has none
  HAPTIC_CLOTH_INLINE LawLanes operator()(const Lanes& s, const StepLanes* steps) const {
    if (intervals_.size() == 1) {  // a linear law
      const Interval& only = intervals_.front();
      return {only.p + s * (only.q + 0.5 * only.r * s), only.q + only.r * s, all(only.r)};
    }
    const Lanes t = smaller(larger((s - begin_) * inverse_step_, Lanes{}), all(last_));
    const Integers interval = __builtin_convertvector(t, Integers);
    Lanes p, q, r;
    if (!memory_) {
      fetch(interval, p, q, r);
      return {p + s * (q + 0.5 * r * s), q + r * s, r};
    }
    const Lanes high = load(steps->high), low = load(steps->low), one = all(1.0), none{};
    const Lanes upper = ifLess(high, s, one, none), lower = ifLess(s, low, one, none);
    fetch(interval + __builtin_convertvector((last_ + 1.0) * (one - upper + lower), Integers), p, q, r);
    p += upper * load(steps->on_upper) + lower * load(steps->on_lower);
    q += (one - upper - lower) * load(steps->play);
    return {p + s * (q + 0.5 * r * s), q + r * s, r};
  }

 private:
  struct Interval {
    double p, q, r;
  };

  HAPTIC_CLOTH_INLINE void fetch(const Integers& which, Lanes& p, Lanes& q, Lanes& r) const {
    for (int l = 0; l < kLanes; ++l) {
      const Interval& interval = intervals_[which[l]];
      p[l] = interval.p;
      q[l] = interval.q;
      r[l] = interval.r;
    }
  }
  void append(const Curve& curve);

  bool memory_;
  double begin_ = 0.0, inverse_step_ = 1.0, last_ = 0.0;  ///< last_: of a curve's intervals
  std::vector<Interval> intervals_;
};

}  // namespace haptic_cloth
