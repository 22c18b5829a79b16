#include "energy/packs.h"

namespace haptic_cloth {
namespace {

/// Curvature of the triples at x, or its change along x.
HAPTIC_CLOTH_INLINE Lanes bend(const TriplePack& pack, const ConstArrays& x, const Lanes3& normal) {
  const Lanes3 centre = gather(x, pack.c);
  return dot(normal, load(pack.left) * (gather(x, pack.l) - centre) +
                         load(pack.right) * (gather(x, pack.r) - centre));
}

}  // namespace

HAPTIC_CLOTH_CLONES double evaluateTriples(TriplePack* packs, int begin, int end, const LawTable& law,
                                           const StepLanes* steps, const ConstArrays& x,
                                           const ConstArrays& normals, const MutableArrays& slots,
                                           int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    TriplePack& pack = packs[p];
    const Lanes3 normal = gather(normals, pack.c);
    const LawLanes moment = law(bend(pack, x, normal), steps ? steps + p : nullptr);
    const Lanes area = load(pack.area);
    energy += area * moment.potential;
    store(slots, first + kLanes * (p - begin), (area * moment.force) * normal);
    store(pack.stiffness, area * moment.slope);
  }
  return total(energy);
}

HAPTIC_CLOTH_CLONES double tripleCurvature(const TriplePack* packs, int begin, int end, const ConstArrays& d,
                                           const ConstArrays& normals) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const Lanes change = bend(packs[p], d, gather(normals, packs[p].c));
    sum += load(packs[p].stiffness) * change * change;
  }
  return total(sum);
}

}  // namespace haptic_cloth
