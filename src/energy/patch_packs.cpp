#include "energy/packs.h"
#include "energy/shear.h"

namespace haptic_cloth {
namespace {

/// Inverse sine. For |s| <= ½ a polynomial in s², fitted to (asin s - s)/s³ in the Chebyshev sense: wrong by
/// less than 2e-17 s³; beyond, asin s = π/2 - 2 asin √((1 - s)/2).
HAPTIC_CLOTH_INLINE Lanes inverseSine(const Lanes& s) {
  constexpr double kFit[] = {0.16666666666666667827,   0.074999999999984329332, 0.044642857146355429783,
                             0.030381944138531247287,  0.022372172942149887875, 0.017352392720869972942,
                             0.013971212973552933304,  0.011479177415184905896, 0.010322814350185779287,
                             0.0054575067186403583004, 0.017400879442694022443, -0.014851887071247203224,
                             0.028757851367421564708};
  const Lanes size = s < 0.0 ? -s : s;
  const Mask large = size > 0.5;
  const Lanes t = large ? 0.5 * (1.0 - size) : size * size;
  const Lanes x = large ? squareRoot(t) : size;
  Lanes fit = all(kFit[12]);
  for (int k = 11; k >= 0; --k) fit = fit * t + kFit[k];
  const Lanes small_angle = x + x * t * fit;
  const Lanes angle = large ? 1.57079632679489661923 - 2.0 * small_angle : small_angle;
  return s < 0.0 ? -angle : angle;
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
    const Lanes nu = squareRoot(dot(u, u)), nv = squareRoot(dot(v, v));
    const Mask proper = nu * nv > 0.0;
    const Lanes iu = proper ? 1.0 / nu : Lanes{}, iv = proper ? 1.0 / nv : Lanes{};
    const Lanes3 uu = iu * u, vv = iv * v;
    const Lanes sine = smaller(larger(dot(uu, vv), all(-1.0)), all(1.0));
    const Lanes cosine = larger(squareRoot(1.0 - sine * sine), all(kLeastCosine));
    const LawLanes shear = law(inverseSine(sine), steps ? steps + p : nullptr);
    const Lanes inverse_cosine = 1.0 / cosine;
    const Lanes3 du = (iu * inverse_cosine) * (vv - sine * uu), dv = (iv * inverse_cosine) * (uu - sine * vv);
    const Lanes3 by_rising = du + dv, by_falling = du - dv;
    const Lanes area = load(pack.area), force = area * shear.force;
    energy += proper ? area * shear.potential : Lanes{};
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

/// Of dE²/d(height)², zero for lanes that hold no patch [N/m].
HAPTIC_CLOTH_INLINE Lanes twistStiffness(const PatchPack& pack, double rigidity) {
  const Lanes area = load(pack.area);
  return area > 0.0 ? 2.0 * rigidity / area : Lanes{};
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
