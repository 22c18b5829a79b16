#include <cmath>

#include "contact/friction_lanes.h"
#include "contact/pair_packs.h"
#include "contact/sample_packs.h"
#include "simd/kernels.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
namespace {

constexpr double kTiny = 1e-300;

HAPTIC_CLOTH_INLINE double lesser(double a, double b) { return b < a ? b : a; }

HAPTIC_CLOTH_INLINE Lanes clamp01(const Lanes& t) { return smaller(larger(t, Lanes{}), all(1.0)); }

/// Values at the four points of one vector of pairs.
struct AtPoints {
  Lanes3 of[4];
};

HAPTIC_CLOTH_INLINE AtPoints gatherPoints(const PairPoints& pack, int l, const ConstArrays& values) {
  AtPoints at;
  for (int c = 0; c < 4; ++c) at.of[c] = gather(values, pack.nodes[c], l);
  if (pack.middles) at.of[0] = all(0.5) * (at.of[0] + gather(values, pack.nodes[4], l));
  return at;
}

/// Σ weights · values
HAPTIC_CLOTH_INLINE Lanes3 weighted(const PairPoints& pack, int l, const ConstArrays& values) {
  const AtPoints at = gatherPoints(pack, l, values);
  Lanes3 sum = load(pack.weights[0] + l) * at.of[0];
  for (int c = 1; c < 4; ++c) sum = sum + load(pack.weights[c] + l) * at.of[c];
  return sum;
}

/// Values at the four points along a direction.
struct AlongPoints {
  Lanes of[4];
};

HAPTIC_CLOTH_INLINE AlongPoints alongPoints(const Lanes3& direction, const PairPoints& pack, int l,
                                            const ConstArrays& values) {
  const AtPoints at = gatherPoints(pack, l, values);
  AlongPoints along;
  for (int c = 0; c < 4; ++c) along.of[c] = dot(direction, at.of[c]);
  return along;
}

struct Nearest {
  Lanes3 between;  ///< from the second part to the first
  Lanes weights[4];
};

/// Weights of the nearest point of a triangle's side, if it is nearer than `least`.
HAPTIC_CLOTH_INLINE void trySide(const Lanes3& p, const Lanes3& a, const Lanes3& b, int at_a, int at_b,
                                 int off, Lanes& least, Lanes* weights) {
  const Lanes3 side = b - a, from = p - a;
  const Lanes t = clamp01(dot(from, side) / larger(dot(side, side), all(kTiny)));
  const Lanes3 rest = from - t * side;
  const Lanes square = dot(rest, rest), none{};
  weights[at_a] = ifLess(square, least, 1.0 - t, weights[at_a]);
  weights[at_b] = ifLess(square, least, t, weights[at_b]);
  weights[off] = ifLess(square, least, none, weights[off]);
  least = smaller(square, least);
}

HAPTIC_CLOTH_INLINE Nearest pointAndTriangle(const Lanes3& p, const Lanes3& a, const Lanes3& b,
                                             const Lanes3& c) {
  Lanes w[3]{};
  Lanes least = all(1e300);
  trySide(p, a, b, 0, 1, 2, least, w);
  trySide(p, b, c, 1, 2, 0, least, w);
  trySide(p, c, a, 2, 0, 1, least, w);
  // Within the sides the foot of the perpendicular is nearest.
  const Lanes3 ab = b - a, ac = c - a, ap = p - a;
  const Lanes uu = dot(ab, ab), uv = dot(ab, ac), vv = dot(ac, ac), up = dot(ap, ab), vp = dot(ap, ac);
  const Lanes scale = 1.0 / larger(uu * vv - uv * uv, all(kTiny));
  const Lanes v = (vv * up - uv * vp) * scale, u = (uu * vp - uv * up) * scale, rest = 1.0 - u - v;
  const Lanes inside = smaller(smaller(u, v), rest);
  w[0] = ifPositive(inside, rest, w[0]);
  w[1] = ifPositive(inside, v, w[1]);
  w[2] = ifPositive(inside, u, w[2]);
  const Lanes3 between = w[0] * (p - a) + w[1] * (p - b) + w[2] * (p - c);
  return {between, {all(1.0), -w[0], -w[1], -w[2]}};
}

HAPTIC_CLOTH_INLINE Nearest twoLines(const Lanes3& a, const Lanes3& b, const Lanes3& c, const Lanes3& d) {
  const Lanes3 u = b - a, v = d - c, r = a - c;
  const Lanes uu = larger(dot(u, u), all(kTiny)), vv = larger(dot(v, v), all(kTiny)), uv = dot(u, v),
              ur = dot(u, r), vr = dot(v, r);
  const Lanes determinant = uu * vv - uv * uv;
  const Lanes limit = 1e-14 * uu * vv;
  Lanes s = ifLess(limit, determinant, clamp01((uv * vr - ur * vv) / larger(determinant, limit)), Lanes{});
  const Lanes t = clamp01((uv * s + vr) / vv);
  s = clamp01((uv * t - ur) / uu);
  const Lanes3 between = r + s * u - t * v;
  return {between, {1.0 - s, s, t - 1.0, -t}};
}

HAPTIC_CLOTH_INLINE void measureOne(PairPack& pack, int l, const AtPoints& x) {
  const Nearest nearest = pack.lines ? twoLines(x.of[0], x.of[1], x.of[2], x.of[3])
                                     : pointAndTriangle(x.of[0], x.of[1], x.of[2], x.of[3]);
  const Lanes distance = squareRoot(dot(nearest.between, nearest.between));
  store3(pack.normal, l, 1.0 / larger(distance, all(kTiny)) * nearest.between);
  store(pack.distance + l, ifPositive(load(pack.range + l), distance, all(1e150)));
  for (int k = 0; k < 4; ++k) store(pack.weights[k] + l, nearest.weights[k]);
}

struct PressureLanes {
  Lanes energy, pressure, stiffness;
};

/// CompressionLaw in lanes. @param distance [m]; positive
HAPTIC_CLOTH_INLINE PressureLanes press(const CompressionLaw::Constants& law, const Lanes& distance) {
  const Lanes none{}, left = smaller(distance / law.barrier_range, all(1.0)), v = 1.0 - left,
                      inverse = 1.0 / left;
  PressureLanes sum{law.barrier_pressure * law.barrier_range * (-0.5 * v * v - v - logarithm(left)),
                    law.barrier_pressure * v * v * inverse,
                    law.barrier_pressure / law.barrier_range * v * (2.0 - v) * inverse * inverse};
  if (law.pressure == 0.0) return sum;
  const Lanes x = larger((law.range - distance) / law.span, none), tested = smaller(x, all(1.0)),
              past = x - tested;
  Lanes steep{};
  for (int l = 0; l < kLanes; ++l) {
    if (x[l] > 0.0) steep[l] = law.pressure * std::pow(tested[l], law.exponent - 1.0);
  }
  const double slope = law.pressure * law.exponent;  // beyond the test
  sum.energy += steep * tested * tested * (law.span / (law.exponent + 1.0)) +
                law.span * past * (law.pressure + 0.5 * slope * past);
  sum.pressure += steep * tested + slope * past;
  sum.stiffness += steep * (law.exponent / law.span);
  return sum;
}

/// Distances over ranges in one vector of pairs; huge in unused lanes.
HAPTIC_CLOTH_INLINE Lanes overRange(const PairPack& pack, int l) {
  return larger(load(pack.distance + l), all(kTiny)) * load(pack.per_range + l);
}

/// Smallest distance of the pairs of a pack now, at least [m].
HAPTIC_CLOTH_INLINE double gapNow(const PairBound& bound, double travelled) {
  return bound.gap - (travelled - bound.measured);
}

/// Distance, over the range, beyond which a pair has no share in what nearer ones press: kFar to the power
/// of -64 is 4e-10.
constexpr double kFar = 1.4;

/// Tells whether all pairs of a pack are that far apart.
HAPTIC_CLOTH_INLINE bool isFar(const PairBound& bound, const PairContext& context) {
  return gapNow(bound, context.travelled) > kFar * context.law.range;
}

/// Writes the forces of one vector of the packs of a stack that press. @return the stored energy
///
/// The distance of a point is a smooth minimum of the distances of its pairs, each over its range,
///
///     Σ q_i^(1-p) / Σ q_i^-p,    p = 64,
///
/// which is exact if all are alike [Lehmer mean]. The minimum itself has a kink where another triangle
/// becomes the nearest: at all points that lie above a valley, a side or a corner.
HAPTIC_CLOTH_INLINE Lanes pressStack(PairPack* stack, const PairBound* bounds, int l,
                                     const PairContext& context) {
  constexpr double kPower = 64.0;
  constexpr int kSquares = 6;  // kPower is 2 to this power
  const int packs = stack->stack;
  Lanes nearest = all(1e150), sum{}, moment{};
  for (int k = 0; k < packs; ++k) {
    if (bounds[k].presses) nearest = smaller(nearest, overRange(stack[k], l));
  }
  for (int k = 0; k < packs; ++k) {
    if (!bounds[k].presses) continue;
    const Lanes q = overRange(stack[k], l), inverse = 1.0 / q;
    Lanes weight = nearest * inverse;
    for (int square = 0; square < kSquares; ++square) weight *= weight;
    store(stack[k].pressing + l, weight);
    store(stack[k].stiffness + l, inverse);  // until the last loop
    sum += weight;
    moment += weight * q;
  }
  const Lanes whole = 1.0 / sum, exact = moment * whole;
  // Rounding does not press at the range.
  const Lanes mean = ifLess(all(1.0 - 1e-14), exact, larger(exact, all(1.0)), exact);
  const Lanes range = load(stack->range + l), area = load(stack->area + l);
  const PressureLanes law = press(context.law, context.law.range * mean);
  const Lanes shared = area * range * whole;
  for (int k = 0; k < packs; ++k) {
    if (!bounds[k].presses) continue;
    const Lanes per_range = load(stack[k].per_range + l), inverse = load(stack[k].stiffness + l);
    const Lanes force =
        shared * per_range * load(stack[k].pressing + l) * (1.0 - kPower * (1.0 - mean * inverse));
    store(stack[k].pressing + l, force * law.pressure);
    store(stack[k].stiffness + l, larger(force, Lanes{}) * (context.law.range * per_range) * law.stiffness);
  }
  return area * (range / context.law.range) * law.energy;
}

HAPTIC_CLOTH_INLINE void clearForces(PairPack& pack) {
  for (int l = 0; l < kPack; l += kLanes) {
    store(pack.pressing + l, Lanes{});
    store(pack.stiffness + l, Lanes{});
  }
}

/// Measures all pairs of a pack. @return the smallest excess of a distance over the range [m]
HAPTIC_CLOTH_INLINE double measure(PairPack& pack, PairBound& bound, double travelled, const ConstArrays& x) {
  Lanes gap = all(1e300), excess = all(1e300);
  for (int l = 0; l < kPack; l += kLanes) {
    measureOne(pack, l, gatherPoints(pack, l, x));
    const Lanes distance = load(pack.distance + l);
    gap = smaller(gap, distance);
    excess = smaller(excess, distance - load(pack.range + l));
  }
  bound.clear -= travelled - bound.measured;
  bound.measured = travelled;
  bound.gap = least(gap);
  return least(excess);
}

/// Smallest distance of the first part of each pair from the second along a direction [m].
/// @param at places of the points along it [m]
HAPTIC_CLOTH_INLINE Lanes smallestApart(const PairPack& pack, const AlongPoints& at) {
  const Lanes second = larger(at.of[2], at.of[3]);
  return pack.lines ? smaller(at.of[0], at.of[1]) - second : at.of[0] - larger(at.of[1], second);
}

/// The same along the normals, for the points at `x`.
HAPTIC_CLOTH_INLINE Lanes smallestApart(const PairPack& pack, int l, const ConstArrays& x) {
  return smallestApart(pack, alongPoints(load3(pack.normal, l), pack, l, x));
}

/// Largest factor of d that uses up the distance but for `left`, whatever the direction of the motion.
HAPTIC_CLOTH_INLINE Lanes cautiousStep(const PairPack& pack, int l, const Lanes& left, const ConstArrays& d) {
  const AtPoints by = gatherPoints(pack, l, d);
  const int firsts = pack.lines ? 2 : 1;
  Lanes square{};
  for (int a = 0; a < firsts; ++a) {
    for (int b = firsts; b < 4; ++b) {
      const Lanes3 apart = by.of[a] - by.of[b];
      square = larger(square, dot(apart, apart));
    }
  }
  return larger(load(pack.distance + l) - left, Lanes{}) / larger(squareRoot(square), all(kTiny));
}

/// Measures the packs of a stack that are not far. @return bound of the excess of its distances [m]
HAPTIC_CLOTH_INLINE double measureStack(PairPack* stack, PairBound* bounds, const PairContext& context,
                                        const ConstArrays& x) {
  double excess = 1e300;
  for (int k = 0; k < stack->stack; ++k) {
    const double least = isFar(bounds[k], context) ? gapNow(bounds[k], context.travelled) - context.law.range
                                                   : measure(stack[k], bounds[k], context.travelled, x);
    excess = lesser(excess, least);
  }
  return excess;
}

}  // namespace

double evaluatePairs(PairPack* packs, PairBound* bounds, int begin, int end, const PairContext& context,
                     const ConstArrays& x) {
  Lanes energy{};
  while (begin < end && bounds[begin].stack == 0) ++begin;
  for (int p = begin; p < end; p += bounds[p].stack) {
    PairPack* const stack = packs + p;
    PairBound* const bound = bounds + p;
    if (context.travelled - bound->measured < bound->clear) continue;
    const double excess = measureStack(stack, bound, context, x);
    const bool acting = !(excess > 0.0);
    for (int k = 0; k < bound->stack; ++k) {
      const bool presses = acting && !isFar(bound[k], context);
      if (bound[k].presses && !presses) clearForces(stack[k]);
      bound[k].presses = presses;
    }
    bound->clear = excess + (context.travelled - bound->measured);
    for (int l = 0; acting && l < kPack; l += kLanes) energy += pressStack(stack, bound, l, context);
  }
  return total(energy);
}

double pairQuadraticForm(const PairPack* packs, const PairBound* bounds, int begin, int end,
                         const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    if (!bounds[p].presses) continue;
    const PairPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes along = load(pack.stiffness + l);
      if (allLess(along, all(kTiny))) continue;  // no contact
      const Lanes normal = dot(load3(pack.normal, l), weighted(pack, l, d));
      sum += along * normal * normal;
    }
  }
  return total(sum);
}

double evaluateDrags(DragPack* packs, int begin, int end, double slip, const ConstArrays& x) {
  Lanes loss{};
  for (int p = begin; p < end; ++p) {
    DragPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes limit = load(pack.limit + l);
      const Lanes3 normal = load3(pack.normal, l);
      const Lanes3 moved = weighted(pack, l, x) - load3(pack.start, l);
      const Lanes3 slipped = moved - dot(normal, moved) * normal;
      const SlipLanes smooth = smoothSlip(slipped, slip);
      const Lanes tangent = limit * smooth.ratio;
      loss += limit * smooth.potential;
      store3(pack.drag, l, tangent * slipped);
      store(pack.stiffness + l, tangent);
      store3(pack.slip, l, slipped);
    }
  }
  return total(loss);
}

double dragQuadraticForm(const DragPack* packs, int begin, int end, double slip, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const DragPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 moved = weighted(pack, l, d);
      const Lanes along = dot(load3(pack.normal, l), moved);
      const Lanes square = larger(dot(moved, moved) - along * along, Lanes{});
      const FrictionForm friction = frictionForm(load3(pack.slip, l), moved, square, load(pack.limit + l),
                                                 load(pack.stiffness + l), slip);
      sum += larger(friction.begins, friction.whole);
    }
  }
  return total(sum);
}

double largestPairStep(PairPack* packs, PairBound* bounds, int begin, int end, const PairLimits& limits,
                       double travelled, const ConstArrays& x, const ConstArrays& d) {
  double most = limits.most;
  for (int p = begin; p < end; ++p) {
    PairPack& pack = packs[p];
    PairBound& bound = bounds[p];
    // No pair of the pack is nearer than this, and none may use up more than `free`.
    const double gap = gapNow(bound, travelled);
    const double free = lesser(limits.share * gap, gap - limits.least_ranges * limits.widest);
    if (most * limits.fastest < free) continue;
    if (bound.measured != travelled) measure(pack, bound, travelled, x);
    Lanes step = all(most);
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 normal = load3(pack.normal, l);
      const AlongPoints at = alongPoints(normal, pack, l, x), by = alongPoints(normal, pack, l, d);
      const Lanes left =
          larger((1.0 - limits.share) * load(pack.distance + l), limits.least_ranges * load(pack.range + l));
      // The nearest point along the normal counts of the first part, the farthest of the second.
      const int firsts = pack.lines ? 2 : 1;
      for (int a = 0; a < firsts; ++a) {
        for (int b = firsts; b < 4; ++b) {
          const Lanes apart = larger(at.of[a] - at.of[b] - left, Lanes{}), closing = by.of[b] - by.of[a];
          step = smaller(step, ifPositive(closing, apart / larger(closing, all(kTiny)), all(1e300)));
        }
      }
      // Rounding can tilt the normal of a small distance so far that it separates nothing.
      const Lanes enough = 0.5 * load(pack.distance + l),
                  apart = ifPositive(load(pack.range + l), smallestApart(pack, at), all(1e300));
      if (!allLess(enough, apart))
        step = smaller(step, ifLess(enough, apart, all(1e300), cautiousStep(pack, l, left, d)));
    }
    most = least(step);
  }
  return most;
}

int firstPassing(const PairPack* packs, const PairBound* bounds, int begin, int end, const StraightWay& way) {
  for (int p = begin; p < end; ++p) {
    if (gapNow(bounds[p], way.travelled) > way.longest) continue;
    const PairPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes apart = smaller(smallestApart(pack, l, way.from), smallestApart(pack, l, way.to));
      if (!allLess(Lanes{}, ifPositive(load(pack.range + l), apart, all(1.0)))) return p;
    }
  }
  return end;
}

double measurePairs(PairPack* packs, PairBound* bounds, int begin, int end, double travelled, double least,
                    const ConstArrays& x) {
  for (int p = begin; p < end; ++p) {
    PairBound& bound = bounds[p];
    if (gapNow(bound, travelled) >= least) continue;
    if (bound.measured != travelled) measure(packs[p], bound, travelled, x);
    least = lesser(least, bound.gap);
  }
  return least;
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
