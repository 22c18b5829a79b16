#include "contact/contact_law.h"
#include "contact/friction_lanes.h"
#include "contact/sample_packs.h"
#include "shape/distance_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
namespace {

HAPTIC_CLOTH_INLINE Lanes3 at(const SamplePack& pack, int l, const ConstArrays& values) {
  if (pack.at_nodes) return gather(values, pack.nodes[0], l);
  Lanes3 sum = load(pack.weights[0] + l) * gather(values, pack.nodes[0], l);
  for (int c = 1; c < 4; ++c) sum = sum + load(pack.weights[c] + l) * gather(values, pack.nodes[c], l);
  return sum;
}

/// Where slip counts from, relative to the origin of a solid that has turned.
HAPTIC_CLOTH_INLINE Lanes3 startOf(const SamplePack& pack, int l, const TurnLanes& turn) {
  const Lanes3 s = load3(pack.start, l);
  if (!turn.turned) return s;
  const double* r = turn.rotation;
  return {r[0] * s.x + r[1] * s.y + r[2] * s.z, r[3] * s.x + r[4] * s.y + r[5] * s.z,
          r[6] * s.x + r[7] * s.y + r[8] * s.z};
}

/// Motion of the samples relative to their solid. They turn about where slip counts from, which is off their
/// place by the slip.
HAPTIC_CLOTH_INLINE Lanes3 against(const SamplePack& pack, int l, const ConstArrays& d,
                                   const SolidMotion& moves) {
  const Lanes3 moved = at(pack, l, d);
  const double *shift = moves.shift, *spin = moves.spin;
  const Lanes3 slides{moved.x - shift[0], moved.y - shift[1], moved.z - shift[2]};
  if (!moves.spins) return slides;
  const Lanes3 lever = startOf(pack, l, moves.turn);
  return {slides.x - (spin[1] * lever.z - spin[2] * lever.y),
          slides.y - (spin[2] * lever.x - spin[0] * lever.z),
          slides.z - (spin[0] * lever.y - spin[1] * lever.x)};
}

HAPTIC_CLOTH_INLINE void storeNothing(SamplePack& pack, int l, double range, const MutableArrays& slots,
                                      int slot) {
  const Lanes zero{};
  store(slots, slot, {zero, zero, zero});
  store(pack.gap + l, all(range));
  store(pack.normal_stiffness + l, zero);
  store(pack.tangent_stiffness + l, zero);
  store(pack.pressing + l, zero);
}

struct PressureLanes {
  Lanes energy, pressure, stiffness;
};

/// ContactLaw in lanes.
HAPTIC_CLOTH_INLINE PressureLanes press(double range, const Lanes& gap, const Lanes& firmest) {
  const Lanes over = larger(firmest - gap, Lanes{});
  const Lanes u = 1.0 - (gap + over) / range, limit = all(ContactLaw::kSwitch), none{};
  const Lanes v = smaller(larger(u, none), limit), past = larger(u - limit, none);
  const Lanes left = 1.0 - v, inverse = 1.0 / left;
  const Lanes energy = -0.5 * v * v - v - logarithm(left), pressure = v * v * inverse;
  const Lanes slope = v * (2.0 - v) * inverse * inverse;
  const Lanes whole = ContactLaw::kPressure * (pressure + past * slope);
  return {ContactLaw::kPressure * range * (energy + past * (pressure + 0.5 * past * slope)) + over * whole,
          whole, ifPositive(over, none, ContactLaw::kPressure / range * slope)};
}

/// Evaluates one vector of samples; adds their stored energy and their friction potential.
HAPTIC_CLOTH_INLINE void evaluateOne(SamplePack& pack, int l, const SampleContext& context,
                                     const Lanes3& position, const Lanes3& moved, const MutableArrays& slots,
                                     int slot, Lanes& energy, Lanes& loss) {
  const DistanceLanes d = distance(context.solid, position);
  const Lanes area = load(pack.area + l);
  const PressureLanes law =
      press(context.range, d.value + load(pack.gap_offset + l), load(pack.firmest_gap + l));
  const Lanes pressing = area * law.pressure;
  energy += area * law.energy;
  const Lanes3 start_normal = load3(pack.start_normal, l);
  const Lanes3 slip = moved - dot(start_normal, moved) * start_normal;
  const SlipLanes smooth = smoothSlip(slip, context.slip);
  const Lanes limit = load(pack.friction + l), tangent = limit * smooth.ratio;
  loss += limit * smooth.potential;
  store(slots, slot, tangent * slip - pressing * d.normal);
  store3(pack.normal, l, d.normal);
  store(pack.gap + l, ifPositive(area, d.value, all(context.range)));
  store(pack.normal_stiffness + l, area * law.stiffness);
  store(pack.tangent_stiffness + l, tangent);
  store(pack.pressing + l, pressing);
  store3(pack.slip, l, slip);
}

}  // namespace

ContactEnergy evaluateSamples(SamplePack* packs, int begin, int end, const SampleContext& context,
                              const ConstArrays& x, const MutableArrays& slots, int first) {
  Lanes energy{}, loss{};
  for (int p = begin; p < end; ++p) {
    SamplePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const int slot = first + kPack * (p - begin) + l;
      const Lanes3 position = at(pack, l, x), start = startOf(pack, l, context.turn);
      const Lanes3 moved{position.x - context.origin[0] - start.x, position.y - context.origin[1] - start.y,
                         position.z - context.origin[2] - start.z};
      const Lanes clearance = larger(load(pack.clearance + l), Lanes{});
      if (context.skip && allLess(dot(moved, moved), clearance * clearance)) {
        storeNothing(pack, l, context.range, slots, slot);
      } else {
        evaluateOne(pack, l, context, position, moved, slots, slot, energy, loss);
      }
    }
  }
  return {total(energy), total(loss)};
}

double sampleQuadraticForm(const SamplePack* packs, int begin, int end, const ConstArrays& d,
                           const SolidMotion& moves, double slip, bool whole_motion) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const SamplePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes across = load(pack.normal_stiffness + l), along = load(pack.tangent_stiffness + l);
      if (allLess(larger(across, along), all(1e-300))) continue;  // no contact
      const Lanes3 moved = against(pack, l, d, moves);
      const Lanes normal = dot(load3(pack.normal, l), moved), start = dot(load3(pack.start_normal, l), moved);
      const Lanes square = larger(dot(moved, moved) - start * start, Lanes{});
      const FrictionForm friction =
          frictionForm(load3(pack.slip, l), moved, square, load(pack.friction + l), along, slip);
      sum += across * normal * normal +
             (whole_motion ? friction.whole : larger(friction.begins, friction.whole));
    }
  }
  return total(sum);
}

double largestStep(const SamplePack* packs, int begin, int end, double share, double firm,
                   const ConstArrays& d, const SolidMotion& moves) {
  Lanes step = all(1e300);
  for (int p = begin; p < end; ++p) {
    const SamplePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes closing = -dot(load3(pack.normal, l), against(pack, l, d, moves));
      const Lanes gap = load(pack.gap + l), nearer = smaller(smaller(gap, closing), load(pack.area + l));
      step = smaller(step, ifPositive(nearer, larger(share * gap, all(firm)) / closing, all(1e300)));
    }
  }
  return least(step);
}

void solidDistances(const SolidLanes& solid, int count, const ConstArrays& x, double* distances,
                    const MutableArrays& normals) {
  for (int n = 0; n < count; n += kLanes) {
    const DistanceLanes d = distance(solid, load(x, n));
    store(distances + n, d.value);
    store(normals, n, d.normal);
  }
}

/// Margins of patches. Solids are convex, so the distance lies above its tangent at each corner; a
/// patch lies between its corners.
void patchMargins(const PatchCorners* corners, int count, double range, const ConstArrays& x,
                  const double* reach, const double* gaps, const ConstArrays& normals, double* margins) {
  for (int p = 0; p < count; ++p) {
    const PackIndices* const nodes = corners[p].at;
    for (int l = 0; l < kPack; l += kLanes) {
      Lanes3 at_corner[4];
      Lanes widest{}, nearest = all(1e300), farthest = all(-1e300);
      for (int c = 0; c < 4; ++c) {
        at_corner[c] = gather(x, nodes[c], l);
        widest = larger(widest, gather(reach, nodes[c], l));
        nearest = smaller(nearest, gather(gaps, nodes[c], l));
      }
      const Lanes margin = range + widest;
      for (int c = 0; c < 4; ++c) {
        const Lanes3 normal = gather(normals, nodes[c], l);
        Lanes nearer{};
        for (int k = 0; k < 4; ++k) nearer = smaller(nearer, dot(normal, at_corner[k] - at_corner[c]));
        farthest = larger(farthest, gather(gaps, nodes[c], l) + nearer);
      }
      const Lanes none = all(-1.0);
      store(margins + kPack * p + l, ifLess(margin, nearest, ifLess(margin, farthest, none, margin), margin));
    }
  }
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
