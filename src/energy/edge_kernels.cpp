#include "energy/law_lanes.h"
#include "energy/packs.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

namespace {

HAPTIC_CLOTH_INLINE Lanes3 span(const EdgePack& pack, int l, const ConstArrays& x) {
  return gather(x, pack.b, l) - gather(x, pack.a, l);
}

HAPTIC_CLOTH_INLINE Lanes strain(const EdgePack& pack, int l, const Lanes& length) {
  return length * load(pack.inverse_length + l) - 1.0;
}

}  // namespace

double evaluateEdges(EdgePack* packs, int begin, int end, const LawView& law, const StepPack* steps,
                     const ConstArrays& x, const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    EdgePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 side = span(pack, l, x);
      const Lanes now = squareRoot(dot(side, side));
      const Lanes inverse = ifPositive(now, 1.0 / now, Lanes{});  // no direction, no force
      const Lanes3 axis = inverse * side;
      const Lanes inverse_length = load(pack.inverse_length + l), area = load(pack.area + l);
      const LawLanes tension = evaluate(law, strain(pack, l, now), steps ? steps + p : nullptr, l);
      const Lanes width = area * inverse_length, force = width * tension.force;
      energy += area * tension.potential;
      store(slots, first + kPack * (p - begin) + l, force * axis);
      store(pack.axis_x + l, axis.x);
      store(pack.axis_y + l, axis.y);
      store(pack.axis_z + l, axis.z);
      store(pack.along + l, width * inverse_length * tension.slope);
      store(pack.across + l, larger(force, Lanes{}) * inverse);
    }
  }
  return total(energy);
}

void edgeStrains(const EdgePack* packs, int begin, int end, const ConstArrays& x, double* strains) {
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 side = span(packs[p], l, x);
      store(strains + kPack * (p - begin) + l, strain(packs[p], l, squareRoot(dot(side, side))));
    }
  }
}

double edgeQuadraticForm(const EdgePack* packs, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const EdgePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 change = span(pack, l, d);
      const Lanes s = dot({load(pack.axis_x + l), load(pack.axis_y + l), load(pack.axis_z + l)}, change);
      const Lanes along = load(pack.along + l), across = load(pack.across + l);
      sum += (along - across) * s * s + across * dot(change, change);
    }
  }
  return total(sum);
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
