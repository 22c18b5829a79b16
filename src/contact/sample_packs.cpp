#include "contact/sample_packs.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

HAPTIC_CLOTH_INLINE Lanes3 at(const SamplePack& pack, const ConstArrays& values) {
  if (pack.at_nodes) return gather(values, pack.nodes[0]);
  Lanes3 sum = load(pack.weights[0]) * gather(values, pack.nodes[0]);
  for (int c = 1; c < 4; ++c) sum = sum + load(pack.weights[c]) * gather(values, pack.nodes[c]);
  return sum;
}

HAPTIC_CLOTH_INLINE Lanes3 load3(const double (*values)[kLanes]) {
  return {load(values[0]), load(values[1]), load(values[2])};
}

HAPTIC_CLOTH_INLINE void nothing(SamplePack& pack, double range, const MutableArrays& slots, int slot) {
  const Lanes zero{};
  store(slots, slot, {zero, zero, zero});
  store(pack.gap, all(range));
  store(pack.normal_stiffness, zero);
  store(pack.tangent_stiffness, zero);
  store(pack.pressing, zero);
}

struct PressureLanes {
  Lanes energy, pressure, stiffness;
};

/// ContactLaw for eight gaps.
HAPTIC_CLOTH_INLINE PressureLanes press(const ContactLaw& law, const Lanes& gap) {
  PressureLanes result;
  for (int l = 0; l < kLanes; ++l) {
    const ContactLaw::Point point = law(gap[l]);
    result.energy[l] = point.energy;
    result.pressure[l] = point.pressure;
    result.stiffness[l] = point.stiffness;
  }
  return result;
}

}  // namespace

HAPTIC_CLOTH_CLONES ContactEnergy evaluateSamples(SamplePack* packs, int begin, int end,
                                                  const SampleContext& context, const ConstArrays& x,
                                                  const MutableArrays& slots, int first) {
  Lanes energy{}, loss{};
  const double range = context.law.range();
  for (int p = begin; p < end; ++p) {
    SamplePack& pack = packs[p];
    const int slot = first + kLanes * (p - begin);
    const Lanes3 position = at(pack, x), start = load3(pack.start);
    const Lanes3 moved{position.x - context.origin[0] - start.x, position.y - context.origin[1] - start.y,
                       position.z - context.origin[2] - start.z};
    const Lanes clearance = larger(load(pack.clearance), Lanes{});
    if (context.skip && !(greatest(dot(moved, moved) - clearance * clearance) >= 0.0)) {
      nothing(pack, range, slots, slot);
      continue;
    }
    const DistanceLanes d = distance(context.solid, position);
    const Lanes area = load(pack.area);
    const PressureLanes law = press(context.law, d.value + load(pack.raised));
    const Lanes pressing = area * law.pressure;
    energy += area * law.energy;
    // Friction, smoothed below `slip`: potential f₀, f₀'/y [Li et al. 2020].
    const Lanes3 start_normal = load3(pack.start_normal);
    const Lanes3 slip = moved - dot(start_normal, moved) * start_normal;
    const Lanes y = squareRoot(dot(slip, slip)), limit = load(pack.friction), t = y / context.slip;
    const Lanes slow = all(context.slip);
    loss += limit * ifLess(y, slow, slow * t * t * (1.0 - t / 3.0), y - slow / 3.0);
    const Lanes tangent = limit * ifLess(y, slow, (2.0 - t) / slow, 1.0 / y);
    store(slots, slot, tangent * slip - pressing * d.normal);
    store(pack.normal[0], d.normal.x);
    store(pack.normal[1], d.normal.y);
    store(pack.normal[2], d.normal.z);
    store(pack.gap, ifPositive(area, d.value, all(range)));
    store(pack.normal_stiffness, area * law.stiffness);
    store(pack.tangent_stiffness, tangent);
    store(pack.pressing, pressing);
  }
  return {total(energy), total(loss)};
}

HAPTIC_CLOTH_CLONES void solidDistances(const SolidLanes& solid, int count, const ConstArrays& x,
                                        double* distances, const MutableArrays& normals) {
  for (int n = 0; n < count; n += kLanes) {
    const DistanceLanes d = distance(solid, load(x, n));
    store(distances + n, d.value);
    store(normals, n, d.normal);
  }
}

/// Solids are convex, so the distance lies above its tangent at each corner, and a patch lies between its
/// corners.
HAPTIC_CLOTH_CLONES void patchMargins(const PatchCorners* packs, int count, double range,
                                      const ConstArrays& x, const double* reach, const double* gaps,
                                      const ConstArrays& normals, double* margins) {
  for (int p = 0; p < count; ++p) {
    const PatchCorners& nodes = packs[p];
    Lanes3 corners[4];
    Lanes widest{}, nearest = all(1e300), farthest = all(-1e300);
    for (int c = 0; c < 4; ++c) {
      corners[c] = gather(x, nodes[c]);
      widest = larger(widest, gather(reach, nodes[c]));
    }
    for (int c = 0; c < 4; ++c) {
      const Lanes gap = gather(gaps, nodes[c]);
      const Lanes3 normal = gather(normals, nodes[c]);
      Lanes nearer{};
      for (const Lanes3& corner : corners) nearer = smaller(nearer, dot(normal, corner - corners[c]));
      nearest = smaller(nearest, gap);
      farthest = larger(farthest, gap + nearer);
    }
    const Lanes margin = range + widest, none = all(-1.0);
    store(margins + kLanes * p, ifLess(margin, nearest, ifLess(margin, farthest, none, margin), margin));
  }
}

HAPTIC_CLOTH_CLONES double sampleCurvature(const SamplePack* packs, int begin, int end, const ConstArrays& d,
                                           const double* d_origin, bool whole_way) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const SamplePack& pack = packs[p];
    const Lanes across = load(pack.normal_stiffness), along = load(pack.tangent_stiffness);
    if (!(greatest(larger(across, along)) > 0.0)) continue;
    Lanes3 moved = at(pack, d);
    moved = {moved.x - d_origin[0], moved.y - d_origin[1], moved.z - d_origin[2]};
    const Lanes normal = dot(load3(pack.normal), moved), start = dot(load3(pack.start_normal), moved);
    const Lanes square = larger(dot(moved, moved) - start * start, Lanes{});
    const Lanes stuck = along * square;
    sum += across * normal * normal +
           (whole_way ? smaller(stuck, load(pack.friction) * squareRoot(square)) : stuck);
  }
  return total(sum);
}

HAPTIC_CLOTH_CLONES double largestStep(const SamplePack* packs, int begin, int end, double share,
                                       const ConstArrays& d, const double* d_origin) {
  Lanes step = all(1e300);
  for (int p = begin; p < end; ++p) {
    const SamplePack& pack = packs[p];
    Lanes3 moved = at(pack, d);
    moved = {moved.x - d_origin[0], moved.y - d_origin[1], moved.z - d_origin[2]};
    const Lanes closing = -dot(load3(pack.normal), moved), gap = load(pack.gap);
    const Lanes nearer = smaller(smaller(gap, closing), load(pack.area));
    step = smaller(step, ifPositive(nearer, share * gap / closing, all(1e300)));
  }
  double least = 1e300;
  for (int l = 0; l < kLanes; ++l) least = std::min(least, step[l]);
  return least;
}

}  // namespace haptic_cloth
