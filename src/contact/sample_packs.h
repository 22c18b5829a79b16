/// Contact samples in packs, as the kernels take them.
#pragma once

#include "contact/contact_law.h"
#include "contact/solid_lanes.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Samples of one solid. Lanes past the last have no area and act on node 0 with nothing.
struct alignas(64) SamplePack {
  double weights[4][kPack];
  double area[kPack];       ///< [m²]
  double raised[kPack];     ///< see ContactSample [m]
  double friction[kPack];   ///< limit of the friction force [N]
  double clearance[kPack];  ///< way the sample can go before it may touch [m]
  double start[3][kPack], start_normal[3][kPack];
  // Left by the last evaluation:
  double normal[3][kPack];
  double gap[kPack];                                         ///< at least the range where nothing touches [m]
  double normal_stiffness[kPack], tangent_stiffness[kPack];  ///< [N/m]
  double pressing[kPack];                                    ///< area times pressure [N]
  PackIndices nodes[4];  ///< corners of the samples' cells; the first alone where `at_nodes`
  bool at_nodes;
};

/// What the samples of one solid have in common in a step.
struct SampleContext {
  SolidLanes solid;
  double origin[3];  ///< what `start` counts from: zero, for the probe its proxy [m]
  bool skip;         ///< samples within their clearance need not be looked at
  double range;      ///< of the contact law: gap at which contact begins [m]
  double slip;       ///< below it, friction is smoothed [m]
};

struct ContactEnergy {
  double contact = 0.0;   ///< stored [J]
  double friction = 0.0;  ///< potential of the friction force: what a slip so far costs [J]
};

// Kernels:
//   evaluateSamples  energy of packs begin..end; gradients by the samples' positions go to slots first, ...,
//                    kPack a pack.
//   sampleCurvature  d · H⁺ d of packs begin..end at the last evaluation. `d_origin` is the solid's motion.
//                    With `whole_way` friction counts as over all of d: what resists a slip of nothing by its
//                    full force resists a long one by no more.
//   largestStep      largest factor of d that lets no sample use up more than `share` of its gap.
//   solidDistances   signed distances [m] and normals of points 0 .. count - 1; arrays are padded.
//   patchMargins     how near each patch's surface must be to a solid to count: the largest reach of its
//                    corners and `range`; -1 where no point of it is so near [m]. `gaps` and `normals` are
//                    those of the nodes, by solidDistances().

}  // namespace haptic_cloth
