#include <cmath>

#include "energy/law_lanes.h"
#include "energy/shear.h"
#include "energy/twist_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
namespace {

/// Angle for the tangent t. For |t| <= ½, which covers most shear of cloth, it is t + t³ P(t²),
/// with P fitted to (atan t - t)/t³ in the Chebyshev sense: the error is below 8e-17 t³. Beyond,
/// each lane calls atan2.
/// @param sine sine of the angle times some factor
/// @param square_cosine square of its cosine times the square of that factor
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

/// Shear of cells (shear.h). With T² = S² + c², R = u² v² + c² and R' its derivative by u² v²: tan γ = D/T,
/// dγ/du = (v - D v² R'/R u)/T, dγ/dv = (u - D u² R'/R v)/T.
struct ShearLanes {
  Lanes3 u, v;                 ///< twice the mean sides
  Lanes uu, vv, product;       ///< u², v², D
  Lanes inverse_size, scaled;  ///< 1/T, D R'/R; zero where there is no cell
  Lanes angle;
};

HAPTIC_CLOTH_INLINE ShearLanes shearOf(const PatchPack& pack, int l, const ConstArrays& x) {
  ShearLanes shear;
  const Lanes3 rising = gather(x, pack.corners.at[3], l) - gather(x, pack.corners.at[0], l);
  const Lanes3 falling = gather(x, pack.corners.at[1], l) - gather(x, pack.corners.at[2], l);
  shear.u = rising + falling;
  shear.v = rising - falling;
  shear.uu = dot(shear.u, shear.u);
  shear.vv = dot(shear.v, shear.v);
  shear.product = dot(shear.u, shear.v);
  const Lanes full = 4.0 * load(pack.area + l), flat = kFlat * full, both = shear.uu * shear.vv;
  const Lanes folded = kFolded * full * full, missing = larger(folded - both, Lanes{});
  Lanes share{};  // of B that is missing
  if (!allLess(folded, both)) share = ifPositive(missing, missing / folded, Lanes{});
  const Lanes padding = flat * flat + 0.5 * missing * share;
  const Lanes square_size = larger(both - shear.product * shear.product, Lanes{}) + padding,
              size = squareRoot(square_size), all_square = both + padding;
  const Lanes inverse = ifPositive(flat, 1.0 / (size * all_square), Lanes{});
  shear.inverse_size = inverse * all_square;
  shear.scaled = inverse * size * shear.product * (1.0 - share);
  shear.angle = angleOf(shear.product * shear.inverse_size, shear.product, square_size);
  return shear;
}

/// Height of the saddle n · (x₁₁ - x₁₀ - x₀₁ + x₀₀), or its change along x.
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
      const ShearLanes cell = shearOf(pack, l, x);
      const LawLanes shear = evaluate(law, cell.angle, steps ? steps + p : nullptr, l);
      const Lanes3 du = cell.inverse_size * (cell.v - (cell.scaled * cell.vv) * cell.u),
                   dv = cell.inverse_size * (cell.u - (cell.scaled * cell.uu) * cell.v);
      const Lanes3 by_rising = du + dv, by_falling = du - dv;
      const Lanes area = load(pack.area + l), force = area * shear.force;
      energy += area * shear.potential;
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

void shearAngles(const PatchPack* packs, int begin, int end, const ConstArrays& x, double* angles) {
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      store(angles + kPack * (p - begin) + l, shearOf(packs[p], l, x).angle);
    }
  }
}

void patchNormals(const PatchCorners* corners, int count, const ConstArrays& x,
                  const MutableArrays& normals) {
  for (int p = 0; p < count; ++p) {
    const PackIndices* const at = corners[p].at;
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes3 a = gather(x, at[3], l) - gather(x, at[0], l),
                   b = gather(x, at[2], l) - gather(x, at[1], l);
      store(normals, kPack * p + l, {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x});
    }
  }
}

void normalise(int count, const MutableArrays& vectors) {
  for (int n = 0; n < count; n += kLanes) {
    const Lanes3 v = load(ConstArrays(vectors), n);
    const Lanes length = squareRoot(dot(v, v));
    store(vectors, n, ifPositive(length, 1.0 / length, Lanes{}) * v);
  }
}

double shearQuadraticForm(const PatchPack* packs, int begin, int end, const ConstArrays& d) {
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

double twistQuadraticForm(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& d,
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
