#include <cmath>

#include "energy/law_lanes.h"
#include "energy/shear.h"
#include "energy/twist_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
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
  if (!allLess(square, all(0.25))) {
    for (int l = 0; l < kLanes; ++l) {
      const double cosine = std::sqrt(square_cosine[l] > 0.0 ? square_cosine[l] : 0.0);
      if (!(square[l] < 0.25)) angle[l] = std::atan2(sine[l], cosine);
    }
  }
  return angle;
}

/// n · (x₁₁ - x₁₀ - x₀₁ + x₀₀), or its change along x.
HAPTIC_CLOTH_INLINE Lanes saddleHeight(const PatchPack& pack, int l, const ConstArrays& x,
                                       const Lanes3& normal) {
  return dot(normal, (gather(x, pack.corners.at[3], l) - gather(x, pack.corners.at[1], l)) -
                         (gather(x, pack.corners.at[2], l) - gather(x, pack.corners.at[0], l)));
}

}  // namespace

double evaluateShears(PatchPack* packs, int begin, int end, const LawView& law, const StepPack* steps,
                      const ConstArrays& x, const MutableArrays& slots, int first, int stride) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    PatchPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 rising = gather(x, pack.corners.at[3], l) - gather(x, pack.corners.at[0], l);
      const Lanes3 falling = gather(x, pack.corners.at[1], l) - gather(x, pack.corners.at[2], l);
      const Lanes3 u = rising + falling, v = rising - falling;
      // With D = u·v and the area S = |u x v|, tan γ = D/S, dγ/du = (v - D/u² u)/S, dγ/dv = (u - D/v² v)/S.
      const Lanes uu = dot(u, u), vv = dot(v, v), both = uu * vv, product = dot(u, v);
      const Lanes least = (kLeastCosine * kLeastCosine) * both, square = both - product * product;
      const Lanes size = squareRoot(larger(square, least));
      const Lanes inverse = ifPositive(both, 1.0 / (size * both), Lanes{});
      const Lanes inverse_size = inverse * both, scaled = inverse * size * product;
      const LawLanes shear =
          evaluate(law, angleOf(product * inverse_size, product, square), steps ? steps + p : nullptr, l);
      const Lanes3 du = inverse_size * (v - (scaled * vv) * u), dv = inverse_size * (u - (scaled * uu) * v);
      const Lanes3 by_rising = du + dv, by_falling = du - dv;
      const Lanes area = load(pack.area + l), force = area * shear.force;
      energy += ifPositive(both, area * shear.potential, Lanes{});
      const int slot = first + kPack * (p - begin) + l;
      store(slots, slot, force * by_rising);
      store(slots, slot + stride, force * by_falling);
      store(pack.rising_x + l, by_rising.x);
      store(pack.rising_y + l, by_rising.y);
      store(pack.rising_z + l, by_rising.z);
      store(pack.falling_x + l, by_falling.x);
      store(pack.falling_y + l, by_falling.y);
      store(pack.falling_z + l, by_falling.z);
      store(pack.stiffness + l, area * shear.slope);
    }
  }
  return total(energy);
}

double shearCurvature(const PatchPack* packs, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    const PatchPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 rising = gather(d, pack.corners.at[3], l) - gather(d, pack.corners.at[0], l);
      const Lanes3 falling = gather(d, pack.corners.at[1], l) - gather(d, pack.corners.at[2], l);
      const Lanes change =
          dot({load(pack.rising_x + l), load(pack.rising_y + l), load(pack.rising_z + l)}, rising) +
          dot({load(pack.falling_x + l), load(pack.falling_y + l), load(pack.falling_z + l)}, falling);
      sum += load(pack.stiffness + l) * change * change;
    }
  }
  return total(sum);
}

double evaluateTwists(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& x,
                      const ConstArrays& normals, const MutableArrays& slots, int first) {
  Lanes energy{};
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 normal = load(normals, kPack * p + l);
      const Lanes height = saddleHeight(packs[p], l, x, normal);
      const Lanes stiffness = twistStiffness(packs[p], l, rigidity);
      energy += 0.5 * stiffness * height * height;
      store(slots, first + kPack * (p - begin) + l, (stiffness * height) * normal);
    }
  }
  return total(energy);
}

double twistCurvature(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& d,
                      const ConstArrays& normals) {
  Lanes sum{};
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes height = saddleHeight(packs[p], l, d, load(normals, kPack * p + l));
      sum += twistStiffness(packs[p], l, rigidity) * height * height;
    }
  }
  return total(sum);
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
