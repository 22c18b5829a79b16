#include "energy/packs.h"

namespace haptic_cloth {

HAPTIC_CLOTH_CLONES double evaluateEdges(EdgePack* packs, int begin, int end, const LawTable& law,
                                         const StepLanes* steps, const ConstArrays& x,
                                         const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    EdgePack& pack = packs[p];
    const Lanes3 span = gather(x, pack.b) - gather(x, pack.a);
    const Lanes now = squareRoot(dot(span, span));
    const Lanes inverse = ifPositive(now, 1.0 / now, Lanes{});  // degenerate: no direction, no force
    const Lanes3 axis = inverse * span;
    const Lanes inverse_length = load(pack.inverse_length), area = load(pack.area);
    const LawLanes tension = law(now * inverse_length - 1.0, steps ? steps + p : nullptr);
    const Lanes width = area * inverse_length, force = width * tension.force;
    energy += area * tension.potential;
    store(slots, first + kLanes * (p - begin), force * axis);
    store(pack.axis_x, axis.x);
    store(pack.axis_y, axis.y);
    store(pack.axis_z, axis.z);
    store(pack.along, width * inverse_length * tension.slope);
    store(pack.across, larger(force, Lanes{}) * inverse);
  }
  return total(energy);
}

HAPTIC_CLOTH_CLONES double edgeCurvature(const EdgePack* packs, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const EdgePack& pack = packs[p];
    const Lanes3 change = gather(d, pack.b) - gather(d, pack.a);
    const Lanes s = dot({load(pack.axis_x), load(pack.axis_y), load(pack.axis_z)}, change);
    sum += load(pack.along) * s * s + load(pack.across) * (dot(change, change) - s * s);
  }
  return total(sum);
}

}  // namespace haptic_cloth
