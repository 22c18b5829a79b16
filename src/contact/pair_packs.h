/// Pairs of parts of the cloth in packs, the format of the kernels.
#pragma once

#include "contact/compression_law.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// The four points of pairs: a point and the corners of a triangle, or the ends of two lines. A point is a
/// node, or the middle of a line.
struct PairPoints {
  PackIndices nodes[5];      ///< the last: the other end of the line whose middle is the first point; of
                             ///< other pairs the first once more
  bool middles;              ///< whether any of these are needed
  double weights[4][kPack];  ///< of the points
};

/// Tells whether the first point of a pair is the middle of a line.
inline bool isMiddle(const PairPoints& pack, int lane) {
  return pack.nodes[0].index[lane] != pack.nodes[4].index[lane];
}

/// Calls visit(node, weight) for the nodes of a pair, with their weights.
template <class Visit>
void forNodes(const PairPoints& pack, int lane, const Visit& visit) {
  const bool middle = isMiddle(pack, lane);
  const double first = (middle ? 0.5 : 1.0) * pack.weights[0][lane];
  visit(pack.nodes[0].index[lane], first);
  if (middle) visit(pack.nodes[4].index[lane], first);
  for (int c = 1; c < 4; ++c) visit(pack.nodes[c].index[lane], pack.weights[c][lane]);
}

/// Pairs of a point and a triangle, or of two lines. The distance of their nearest points is
/// |Σ weights · x|, with the sum over their points. Unused lanes have no range.
///
/// The triangles near a point on one of its sides share its area and pressure. They stand in one lane of
/// consecutive packs, a stack, the nearest first.
struct alignas(64) PairPack : PairPoints {
  double area[kPack];       ///< [m²]
  double range[kPack];      ///< distance at which contact begins; 0 in unused lanes [m]
  double per_range[kPack];  ///< 1 / range; 1 in unused lanes [1/m]
  int stack;                ///< number of packs of the stack that begins here; 0 within a stack
  bool lines;               ///< pairs of lines, which share nothing: stacks of one pack
  // Results of the last evaluation, and the weights:
  double normal[3][kPack];  ///< direction of the distance
  double distance[kPack];   ///< [m]
  double pressing[kPack];   ///< force; of a point, this triangle's part of it, which may be negative [N]
  double stiffness[kPack];  ///< along the normal [N/m]
};

/// Friction of pairs that press at the start of a step, in packs. They slip by Σ weights · x - start
/// across their normal. Unused lanes have no limit.
struct DragPack : PairPoints {
  double start[3][kPack];   ///< Σ weights · x without slip [m]
  double normal[3][kPack];  ///< at the start of the step
  double limit[kPack];      ///< of the force [N]
  int pair[kPack];          ///< kPack times its pack, plus its lane
  // Results of the last evaluation:
  double drag[3][kPack];    ///< energy gradient by Σ weights · x [N]
  double stiffness[kPack];  ///< force over slip [N/m]
  double slip[3][kPack];    ///< across the normal [m]
};

/// Bounds that hold for a pack since it was measured. While nothing can press, the pack itself is not read.
struct PairBound {
  double measured;  ///< way travelled when the pack was measured [m]
  double gap;       ///< smallest distance of its pairs then [m]
  double clear;     ///< in the first pack of a stack: how far the nodes may travel since then before any
                    ///< pair of the stack presses [m]
  int stack;        ///< as in the pack
  bool presses;     ///< whether the pack has forces at the last evaluation

  /// Ends what is known of distances.
  void forget() { measured = gap = clear = 0.0; }
};

/// Values that all pairs share in an evaluation.
struct PairContext {
  /// Pressure by distance. A pair with a shorter range has the same law over it.
  CompressionLaw::Constants law;
  double travelled;  ///< bound of how far any distance has changed in the step so far [m]
};

/// Limits of a step along a direction d.
struct PairLimits {
  double share;         ///< largest share of a pair's distance that it may use up [-]
  double least_ranges;  ///< smallest distance that it may leave, over the pair's range [-]
  double most;          ///< largest factor of d to be returned [-]
  double fastest;       ///< bound of how far any distance changes by d [m]
  double widest;        ///< largest range of a pair [m]
};

/// The straight way of the nodes in a step.
struct StraightWay {
  ConstArrays from, to;  ///< all nodes [m]
  double longest;        ///< bound of how far any distance changes on it [m]
  double travelled;      ///< as in PairContext, at its end [m]
};

// Kernels:
//   evaluatePairs      measures the stacks that begin in begin..end, unless they cannot press yet, and
//                      writes their forces. Returns their energy.
//   pairQuadraticForm  quadratic form d · H⁺ d of packs begin..end at the last evaluation [J].
//   evaluateDrags      writes the friction of packs begin..end. Returns its potential [J].
//                      @param slip below which friction is smoothed [m]
//   dragQuadraticForm  as pairQuadraticForm, for friction: at the beginning of d or over the whole of it,
//                      whichever is more.
//   largestPairStep    largest factor of d within the limits for packs begin..end. Packs that were not
//                      measured at x are, if they might limit the step.
//                      The normal separates both parts of a pair: they do not meet before one of their
//                      nodes has passed the other part along it.
//   firstPassing       first of packs begin..end with a pair that may meet on a straight way: it is longer
//                      than their distance, and the normal separates both parts at one end of it only.
//                      `end` if there is none.
//   measurePairs       measures packs begin..end that may be nearer than `least` [m]. Returns the smallest
//                      distance, or `least` if all are farther.

}  // namespace haptic_cloth
