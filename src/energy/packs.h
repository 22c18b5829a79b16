/// Elements in packs, as the kernels take them. Lanes past the last element have no width and act on node 0
/// with nothing. What an evaluation leaves behind steers the solve (step lengths and preconditioner), for
/// which single precision does.
#pragma once

#include "haptic_cloth/loop.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Memory of the elements of a pack, Loop::Step by Loop::Step.
struct StepPack {
  double play[kPack], low[kPack], high[kPack], on_lower[kPack], on_upper[kPack];

  Loop::Step get(int lane) const {
    return {play[lane], low[lane], high[lane], on_lower[lane], on_upper[lane]};
  }
  void set(int lane, const Loop::Step& step) {
    play[lane] = step.play;
    low[lane] = step.low;
    high[lane] = step.high;
    on_lower[lane] = step.on_lower;
    on_upper[lane] = step.on_upper;
  }
};

struct alignas(64) EdgePack {
  double inverse_length[kPack], area[kPack];  ///< [1/m], [m²]
  // Left by the last evaluation:
  float axis_x[kPack], axis_y[kPack], axis_z[kPack];
  float along[kPack], across[kPack];  ///< stiffness along the axis and across it [N/m]
  PackIndices a, b;                   ///< nodes
};

struct alignas(64) TriplePack {
  double left[kPack], right[kPack], area[kPack];  ///< [1/m²], [m²]
  float stiffness[kPack];                         ///< left by the last evaluation [N·m³]
  PackIndices l, c, r;                            ///< nodes
};

struct alignas(64) PatchPack {
  double area[kPack];  ///< [m²]
  // Left by the last evaluation:
  float rising_x[kPack], rising_y[kPack], rising_z[kPack];
  float falling_x[kPack], falling_y[kPack], falling_z[kPack];
  float stiffness[kPack];  ///< [N·m]
  PatchCorners corners;
};

// Kernels over packs begin..end:
//   evaluate…     energy [J]; forces go to slots first, first + 1, ..., kPack a pack. `steps` is the memory
//   of
//                 the packs, null where the law has none. A shear's falling side lies `stride` slots after
//                 its rising side.
//   edgeStrains,  deformation at x, as evaluate… has it: [-], [1/m], [rad]; kPack values a pack. Where there
//   …Curvatures,  is no element they say nothing.
//   shearAngles
//   patchNormals  normals of `count` packs of cells, as long as twice their area; kPack a pack. normalise
//                 makes `count` vectors unit vectors, but for those of no length.
//   …Curvature    d · H⁺ d at the last evaluation.
//   add…Blocks    adds what the packs have of H⁺ at each of their nodes [N/m], from the last evaluation.

}  // namespace haptic_cloth
