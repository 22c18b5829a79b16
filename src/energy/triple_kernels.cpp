#include "energy/law_lanes.h"
#include "energy/packs.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
namespace {

/// Curvature of the triples at x, or its change along x.
HAPTIC_CLOTH_INLINE Lanes bend(const TriplePack& pack, const SagittaPack* sagittas, int l,
                               const ConstArrays& x, const Lanes3& normal) {
  const Lanes3 centre = gather(x, pack.c, l);
  Lanes3 bent = load(pack.left + l) * (gather(x, pack.l, l) - centre) +
                load(pack.right + l) * (gather(x, pack.r, l) - centre);
  if (pack.sagitta >= 0) {
    const SagittaPack& beside = sagittas[pack.sagitta];
    bent = bent - load(beside.coefficient + l) *
                      ((gather(x, beside.a, l) - centre) + (gather(x, beside.b, l) - centre));
  }
  return dot(normal, bent);
}

}  // namespace

double evaluateTriples(TriplePack* packs, const SagittaPack* sagittas, int begin, int end, const LawView& law,
                       const StepPack* steps, const ConstArrays& x, const ConstArrays& normals,
                       const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    TriplePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 normal = gather(normals, pack.c, l);
      const LawLanes moment =
          evaluate(law, bend(pack, sagittas, l, x, normal), steps ? steps + p : nullptr, l);
      const Lanes area = load(pack.area + l);
      energy += area * moment.potential;
      store(slots, first + kPack * (p - begin) + l, (area * moment.force) * normal);
      store(pack.stiffness + l, area * moment.slope);
    }
  }
  return total(energy);
}

void tripleCurvatures(const TriplePack* packs, const SagittaPack* sagittas, int begin, int end,
                      const ConstArrays& x, const ConstArrays& normals, double* curvatures) {
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      store(curvatures + kPack * (p - begin) + l,
            bend(packs[p], sagittas, l, x, gather(normals, packs[p].c, l)));
    }
  }
}

double tripleQuadraticForm(const TriplePack* packs, const SagittaPack* sagittas, int begin, int end,
                           const ConstArrays& d, const ConstArrays& normals) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes change = bend(packs[p], sagittas, l, d, gather(normals, packs[p].c, l));
      sum += load(packs[p].stiffness + l) * change * change;
    }
  }
  return total(sum);
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
