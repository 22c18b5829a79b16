/// Contact samples in packs, the format of the kernels.
#pragma once

#include "contact/contact_law.h"
#include "shape/solid_lanes.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Samples of one solid. Unused lanes have no area and refer to node 0.
struct alignas(64) SamplePack {
  double weights[4][kPack];
  double area[kPack];         ///< [m²]
  double gap_offset[kPack];   ///< see ContactLaw::Count [m]
  double firmest_gap[kPack];  ///< the same
  double friction[kPack];     ///< limit of the friction force [N]
  double clearance[kPack];    ///< distance that the sample can move before it may touch [m]
  double start[3][kPack], start_normal[3][kPack];  ///< where slip counts from, and normal there
  // Results of the last evaluation:
  double normal[3][kPack];
  /// At least the range if nothing touches [m].
  double gap[kPack];
  double normal_stiffness[kPack], tangent_stiffness[kPack];  ///< [N/m]
  double pressing[kPack];                                    ///< area times pressure [N]
  double slip[3][kPack];  ///< in the tangent plane, with the elastic slip of the start [m]
  PackIndices nodes[4];   ///< corners of the samples' cells; only the first if `at_nodes`
  bool at_nodes;
};

/// Rotation by which a solve has turned a solid since its samples were started.
struct TurnLanes {
  bool turned;         ///< false: it is the identity
  double rotation[9];  ///< by rows
};

/// How a solid moves along a direction.
struct SolidMotion {
  double shift[3];  ///< of its origin [m]
  double spin[3];   ///< angular [rad]
  bool spins;       ///< false: `spin` is zero
  TurnLanes turn;
};

/// Values that all samples of one solid share in a step.
struct SampleContext {
  SolidLanes solid;
  TurnLanes turn;
  double origin[3];  ///< origin of `start`: zero, or the proxy of a probe [m]
  bool skip;         ///< samples within their clearance may be skipped
  double range;      ///< of the contact law: gap at which contact begins [m]
  double slip;       ///< slip below which friction is smoothed [m]
};

struct ContactEnergy {
  double contact = 0.0;   ///< stored [J]
  double friction = 0.0;  ///< potential of friction [J]
};

// Kernels:
//   evaluateSamples      energy of packs begin..end; the gradients by the samples' positions go to
//                        slots first, ..., kPack for each pack.
//   sampleQuadraticForm  quadratic form d · H⁺ d of packs begin..end at the last evaluation [J].
//                        `moves` is that of the solid, `slip` that of SampleContext. With
//                        `whole_motion`, friction counts as over the whole of d: its force changes to
//                        at most its limit, however stiff it is. Without, it counts at least as at the
//                        beginning of d.
//   largestStep          largest factor of d at which no sample that is outside uses up more than
//                        `share` of its gap, or `firm` where that is more [m].
//   solidDistances       signed distances [m] and normals of points 0 .. count - 1; arrays are
//                        padded.
//   patchMargins         gap below which points of each patch count: `range` plus the largest reach
//                        of its corners; -1 if no point of the patch can be that near [m]. `gaps`
//                        and `normals` are those of the nodes, from solidDistances().

}  // namespace haptic_cloth
