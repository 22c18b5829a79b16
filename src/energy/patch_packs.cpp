#include <algorithm>
#include <cmath>

#include "energy/packs.h"
#include "energy/shear.h"

namespace haptic_cloth {
namespace {

/// Angle of tangent t. For |t| <= ½, as far as cloth mostly shears, t + t³ P(t²), P fitted to
/// (atan t - t)/t³ in the Chebyshev sense: wrong by less than 8e-17 t³; beyond, lane by lane.
/// @param sine of the angle times some factor  @param square of its cosine, times that factor's
HAPTIC_CLOTH_INLINE Lanes angleOf(const Lanes& t, const Lanes& sine, const Lanes& square_cosine) {
  constexpr double kFit[] = {-0.33333333333333326, 0.199999999999916,    -0.14285714284106285,
                             0.11111110990139533,  -0.09090904370311348, 0.07692198451257941,
                             -0.06665052856794013, 0.058664967492257074, -0.05157516225552972,
                             0.04283578705573422,  -0.02895352123252625, 0.011152908092096216};
  const Lanes square = t * t;
  Lanes fit = all(kFit[11]);
  for (int k = 10; k >= 0; --k) fit = fit * square + kFit[k];
  Lanes angle = t + t * square * fit;
  if (!(greatest(square) <= 0.25)) {
    for (int l = 0; l < kLanes; ++l) {
      if (!(square[l] <= 0.25)) angle[l] = std::atan2(sine[l], std::sqrt(std::max(square_cosine[l], 0.0)));
    }
  }
  return angle;
}

}  // namespace

HAPTIC_CLOTH_CLONES double evaluateShears(PatchPack* packs, int begin, int end, const LawTable& law,
                                          const StepLanes* steps, const ConstArrays& x,
                                          const MutableArrays& slots, int first, int stride) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    PatchPack& pack = packs[p];
    const Lanes3 rising = gather(x, pack.corners[3]) - gather(x, pack.corners[0]);
    const Lanes3 falling = gather(x, pack.corners[1]) - gather(x, pack.corners[2]);
    const Lanes3 u = rising + falling, v = rising - falling;
    // With D = u·v and the area S = |u x v|, tan γ = D/S, dγ/du = (v - D/u² u)/S, dγ/dv = (u - D/v² v)/S.
    const Lanes uu = dot(u, u), vv = dot(v, v), both = uu * vv, product = dot(u, v);
    const Lanes least = (kLeastCosine * kLeastCosine) * both, square = both - product * product;
    const Lanes size = squareRoot(larger(square, least));
    const Lanes inverse = ifPositive(both, 1.0 / (size * both), Lanes{});
    const Lanes inverse_size = inverse * both, scaled = inverse * size * product;
    const LawLanes shear = law(angleOf(product * inverse_size, product, square), steps ? steps + p : nullptr);
    const Lanes3 du = inverse_size * (v - (scaled * vv) * u), dv = inverse_size * (u - (scaled * uu) * v);
    const Lanes3 by_rising = du + dv, by_falling = du - dv;
    const Lanes area = load(pack.area), force = area * shear.force;
    energy += ifPositive(both, area * shear.potential, Lanes{});
    const int slot = first + kLanes * (p - begin);
    store(slots, slot, force * by_rising);
    store(slots, slot + stride, force * by_falling);
    store(pack.rising_x, by_rising.x);
    store(pack.rising_y, by_rising.y);
    store(pack.rising_z, by_rising.z);
    store(pack.falling_x, by_falling.x);
    store(pack.falling_y, by_falling.y);
    store(pack.falling_z, by_falling.z);
    store(pack.stiffness, area * shear.slope);
  }
  return total(energy);
}

HAPTIC_CLOTH_CLONES double shearCurvature(const PatchPack* packs, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const PatchPack& pack = packs[p];
    const Lanes3 rising = gather(d, pack.corners[3]) - gather(d, pack.corners[0]);
    const Lanes3 falling = gather(d, pack.corners[1]) - gather(d, pack.corners[2]);
    const Lanes change = dot({load(pack.rising_x), load(pack.rising_y), load(pack.rising_z)}, rising) +
                         dot({load(pack.falling_x), load(pack.falling_y), load(pack.falling_z)}, falling);
    sum += load(pack.stiffness) * change * change;
  }
  return total(sum);
}

namespace {

/// n · (x₁₁ - x₁₀ - x₀₁ + x₀₀), or its change along x.
HAPTIC_CLOTH_INLINE Lanes saddleHeight(const PatchPack& pack, const ConstArrays& x, const Lanes3& normal) {
  return dot(normal, (gather(x, pack.corners[3]) - gather(x, pack.corners[1])) -
                         (gather(x, pack.corners[2]) - gather(x, pack.corners[0])));
}

}  // namespace

HAPTIC_CLOTH_CLONES double evaluateTwists(const PatchPack* packs, int begin, int end, double rigidity,
                                          const ConstArrays& x, const ConstArrays& normals,
                                          const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    const Lanes3 normal = load(normals, kLanes * p);
    const Lanes height = saddleHeight(packs[p], x, normal), stiffness = twistStiffness(packs[p], rigidity);
    energy += 0.5 * stiffness * height * height;
    store(slots, first + kLanes * (p - begin), (stiffness * height) * normal);
  }
  return total(energy);
}

HAPTIC_CLOTH_CLONES double twistCurvature(const PatchPack* packs, int begin, int end, double rigidity,
                                          const ConstArrays& d, const ConstArrays& normals) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const Lanes height = saddleHeight(packs[p], d, load(normals, kLanes * p));
    sum += twistStiffness(packs[p], rigidity) * height * height;
  }
  return total(sum);
}

}  // namespace haptic_cloth
