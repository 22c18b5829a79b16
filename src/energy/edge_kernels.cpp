#include "energy/law_lanes.h"
#include "energy/packs.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

double evaluateEdges(EdgePack* packs, int begin, int end, const LawView& law, const StepPack* steps,
                     const ConstArrays& x, const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    EdgePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 span = gather(x, pack.b, l) - gather(x, pack.a, l);
      const Lanes now = squareRoot(dot(span, span));
      const Lanes inverse = ifPositive(now, 1.0 / now, Lanes{});  // degenerate: no direction, no force
      const Lanes3 axis = inverse * span;
      const Lanes inverse_length = load(pack.inverse_length + l), area = load(pack.area + l);
      const LawLanes tension = evaluate(law, now * inverse_length - 1.0, steps ? steps + p : nullptr, l);
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

double edgeCurvature(const EdgePack* packs, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const EdgePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 change = gather(d, pack.b, l) - gather(d, pack.a, l);
      const Lanes s = dot({load(pack.axis_x + l), load(pack.axis_y + l), load(pack.axis_z + l)}, change);
      const Lanes along = load(pack.along + l), across = load(pack.across + l);
      sum += (along - across) * s * s + across * dot(change, change);
    }
  }
  return total(sum);
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
