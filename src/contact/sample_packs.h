/// Contact samples in packs of eight, as loops over lanes want them.
#pragma once

#include "contact/contact_law.h"
#include "contact/solid_lanes.h"
#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Eight samples of one solid. Lanes past the last have no area and act on node 0 with nothing.
struct SamplePack {
  NodeLanes nodes[4];  ///< corners of the samples' cells; the first alone where `at_nodes`
  double weights[4][kLanes];
  bool at_nodes;
  double area[kLanes];       ///< [m²]
  double raised[kLanes];     ///< see ContactSample [m]
  double friction[kLanes];   ///< limit of the friction force [N]
  double clearance[kLanes];  ///< way the sample can go before it may touch [m]
  double start[3][kLanes], start_normal[3][kLanes];
  // left by the last evaluation:
  double normal[3][kLanes];
  double gap[kLanes];  ///< at least the range where nothing touches [m]
  double normal_stiffness[kLanes], tangent_stiffness[kLanes];  ///< [N/m]
  double pressing[kLanes];                                     ///< area times pressure [N]
};

/// What the samples of one solid have in common in a step.
struct SampleContext {
  SolidLanes solid;
  double origin[3];  ///< what `start` counts from: zero, for the probe its proxy [m]
  bool skip;         ///< samples within their clearance need not be looked at
  ContactLaw law;
  double slip;  ///< below it, friction is smoothed [m]
};

struct ContactEnergy {
  double contact = 0.0;   ///< stored [J]
  double friction = 0.0;  ///< potential of the friction force: what a slip so far costs [J]
};

/// Energy of packs begin..end; their force gradients go to slots first, first + 1, ..., eight a pack.
ContactEnergy evaluateSamples(SamplePack* packs, int begin, int end, const SampleContext& context,
                              const ConstArrays& x, const MutableArrays& slots, int first);

/// d · H⁺ d of packs begin..end at the last evaluation. @param d_origin of the solid  @param whole_way
/// friction counts as over all of d: what resists a slip of nothing by its full force resists a long one by
/// no more
double sampleCurvature(const SamplePack* packs, int begin, int end, const ConstArrays& d,
                       const double* d_origin, bool whole_way);

/// Largest factor of d that lets no sample use up more than `share` of its gap to the solid.
double largestStep(const SamplePack* packs, int begin, int end, double share, const ConstArrays& d,
                   const double* d_origin);

/// Signed distances [m] and normals of points 0 .. count - 1. @pre all arrays are padded to whole lanes
void solidDistances(const SolidLanes& solid, int count, const ConstArrays& x, double* distances,
                    const MutableArrays& normals);

/// How near each of eight patches' surface must be to a solid to count: the largest reach of its corners and
/// `range`; -1 where no point of it is so near [m]. @param gaps, normals of the nodes, by solidDistances()
void patchMargins(const PatchCorners* packs, int count, double range, const ConstArrays& x,
                  const double* reach, const double* gaps, const ConstArrays& normals, double* margins);

}  // namespace haptic_cloth
