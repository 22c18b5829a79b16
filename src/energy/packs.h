/// Elements in packs, the format of the kernels. Unused lanes have no area and refer to node 0.
/// Results of an evaluation control the solve (step sizes and preconditioner) and are kept in
/// single precision.
#pragma once

#include "haptic_cloth/loop.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Memory of the elements of a pack: one Loop::Step for each lane.
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
  // Results of the last evaluation:
  float axis_x[kPack], axis_y[kPack], axis_z[kPack];
  float along[kPack], across[kPack];  ///< stiffness along the axis and across it [N/m]
  PackIndices a, b;                   ///< nodes
};

struct alignas(64) TriplePack {
  double left[kPack], right[kPack], area[kPack];  ///< [1/m²], [m²]
  float stiffness[kPack];                         ///< result of the last evaluation [N·m³]
  PackIndices l, c, r;                            ///< nodes
  int sagitta = -1;                               ///< its SagittaPack, -1: none
};

/// Sagittas that the triples of a pack take off (see Triple); few packs have any.
struct alignas(64) SagittaPack {
  double coefficient[kPack];  ///< [1/m²]
  PackIndices a, b;           ///< nodes
};

struct alignas(64) PatchPack {
  double area[kPack];  ///< [m²]
  // Results of the last evaluation:
  float rising_x[kPack], rising_y[kPack], rising_z[kPack];
  float falling_x[kPack], falling_y[kPack], falling_z[kPack];
  float stiffness[kPack];  ///< [N·m]
  PatchCorners corners;
};

// Kernels over packs begin..end:
//   evaluate…       energy [J]. Forces go to slots first, first + 1, ..., kPack for each pack.
//                   `steps` is the memory of the packs, null if the law has none. The falling side
//                   of a shear lies `stride` slots after its rising side.
//   edgeStrains,    deformation at x as in evaluate…: [-], [1/m], [rad]; kPack values for each
//   …Curvatures,    pack. Values of unused lanes have no meaning.
//   shearAngles
//   patchNormals    normals of `count` packs of cells, with twice the area as length; kPack for
//                   each pack. normalise scales `count` vectors to length 1, except those of length
//                   zero.
//   …QuadraticForm  quadratic form d · H⁺ d at the last evaluation [J].
//   add…Blocks      adds the packs' part of H⁺ at their nodes [N/m], from the last evaluation.

}  // namespace haptic_cloth
