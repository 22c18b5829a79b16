#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

/// Copies nodes begin..end from a vector of unknowns (all x of the `free` nodes, all y, all z) to
/// points with x, y, z and a zero.
void loadPoints(const double* __restrict__ gradient, int free, int begin, int end,
                float* __restrict__ values) {
  for (int n = begin; n < end; ++n) {
    for (int c = 0; c < 3; ++c) values[4 * n + c] = static_cast<float>(gradient[c * free + n]);
    values[4 * n + 3] = 0.0f;
  }
}

/// Writes the direction z of nodes begin..end: the correction of the hats, `values`, plus the
/// node's inverted block times the gradient. A node whose block is zero does not move.
void addOwnBlocks(const BlockArrays& own, const double* gradient, const float* values, int free, int begin,
                  int end, double* __restrict__ z) {
  const double *const xxs = own.entry[0], *const yys = own.entry[1], *const zzs = own.entry[2],
                      *const yzs = own.entry[3], *const xzs = own.entry[4], *const xys = own.entry[5];
  for (int n = begin; n < end; ++n) {
    const double xx = xxs[n], yy = yys[n], zz = zzs[n], yz = yzs[n], xz = xzs[n], xy = xys[n];
    const double gx = gradient[n], gy = gradient[free + n], gz = gradient[2 * free + n];
    const float* const hats = values + 4 * n;
    const double moves = xx > 0.0 ? 1.0 : 0.0;
    z[n] = moves * (static_cast<double>(hats[0]) + xx * gx + xy * gy + xz * gz);
    z[free + n] = moves * (static_cast<double>(hats[1]) + xy * gx + yy * gy + yz * gz);
    z[2 * free + n] = moves * (static_cast<double>(hats[2]) + xz * gx + yz * gy + zz * gz);
  }
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
