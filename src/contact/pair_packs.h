/// Pairs of parts of the cloth in packs, the format of the kernels.
#pragma once

#include "contact/compression_law.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Pairs of a node and a triangle, or of two lines. The distance of their nearest points is
/// |Σ weights · x|, with the sum over four nodes: the node and the corners of the triangle, or the
/// ends of both lines. Unused lanes have no range.
struct alignas(64) PairPack {
  PackIndices nodes[4];
  double area[kPack];      ///< [m²]
  double range[kPack];     ///< distance at which contact begins; 0 in unused lanes [m]
  double friction[kPack];  ///< limit of the friction force [N]
  double start_weights[4][kPack];
  double start[3][kPack];         ///< Σ start_weights · x at the start of the step [m]
  double start_normal[3][kPack];  ///< normal at the start of the step
  /// First lane of the group: of the pairs of a group only the nearest presses.
  int group[kPack];
  bool lines;  ///< pairs of lines
  // Results of the last evaluation:
  double weights[4][kPack];
  double normal[3][kPack];       ///< direction of the distance
  double distance[kPack];        ///< [m]
  double pressing[kPack];        ///< area times pressure [N]
  double stiffness[kPack];       ///< along the normal [N/m]
  double drag[3][kPack];         ///< gradient of friction by Σ start_weights · x [N]
  double drag_stiffness[kPack];  ///< across start_normal [N/m]
};

/// Values that all pairs share in a step.
struct PairContext {
  /// Pressure by distance. A pair with a shorter range has the same law over it.
  CompressionLaw::Constants law;
  double slip;  ///< slip below which friction is smoothed [m]
};

// Kernels:
//   evaluatePairs      measures packs begin..end and writes their forces. Returns their energy.
//   pairQuadraticForm  quadratic form d · H⁺ d of packs begin..end at the last evaluation [J].
//   largestPairStep    largest factor of d at which no pair uses up more than `share` of its distance, nor
//                      comes nearer than `least_ranges` times its range.
//                      The normal separates both parts of a pair: they do not meet before one of their
//                      nodes has passed the other part along it.

}  // namespace haptic_cloth
