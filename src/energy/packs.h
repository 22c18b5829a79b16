/// Elements in packs of eight, as loops over lanes want them. Lanes past the last element have no width and
/// act on node 0 with nothing.
#pragma once

#include <vector>

#include "energy/law_table.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "mesh/field.h"

namespace haptic_cloth {

struct EdgePack {
  NodeLanes a, b;
  double inverse_length[kLanes], area[kLanes];  ///< [1/m], [m²]
  // left by the last evaluation:
  double axis_x[kLanes], axis_y[kLanes], axis_z[kLanes];
  double along[kLanes], across[kLanes];  ///< stiffness along the axis and across it [N/m]
};

struct TriplePack {
  NodeLanes l, c, r;
  double left[kLanes], right[kLanes], area[kLanes];  ///< [1/m²], [m²]
  double stiffness[kLanes];                          ///< left by the last evaluation [N·m³]
};

struct PatchPack {
  PatchCorners corners;
  double area[kLanes];  ///< [m²]
  // left by the last evaluation:
  double rising_x[kLanes], rising_y[kLanes], rising_z[kLanes];
  double falling_x[kLanes], falling_y[kLanes], falling_z[kLanes];
  double stiffness[kLanes];  ///< [N·m]
};

/// Of twist, d²E/d(height)² of eight patches; zero for lanes that hold none [N/m].
static HAPTIC_CLOTH_INLINE Lanes twistStiffness(const PatchPack& pack, double rigidity) {
  const Lanes area = load(pack.area);
  return ifPositive(area, 2.0 * rigidity / area, Lanes{});
}

/// Evaluates packs begin..end at x: forces into slots first, first + 1, ..., eight a pack. @return energy [J]
/// @param steps memory of the packs, null where the law has none
double evaluateEdges(EdgePack* packs, int begin, int end, const LawTable& law, const StepLanes* steps,
                     const ConstArrays& x, const MutableArrays& slots, int first);
double evaluateTriples(TriplePack* packs, int begin, int end, const LawTable& law, const StepLanes* steps,
                       const ConstArrays& x, const ConstArrays& normals, const MutableArrays& slots,
                       int first);
/// Shear; slots of falling sides lie `stride` after those of rising ones.
double evaluateShears(PatchPack* packs, int begin, int end, const LawTable& law, const StepLanes* steps,
                      const ConstArrays& x, const MutableArrays& slots, int first, int stride);
double evaluateTwists(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& x,
                      const ConstArrays& normals, const MutableArrays& slots, int first);

/// d · H⁺ d of packs begin..end at the last evaluation.
double edgeCurvature(const EdgePack* packs, int begin, int end, const ConstArrays& d);
double tripleCurvature(const TriplePack* packs, int begin, int end, const ConstArrays& d,
                       const ConstArrays& normals);
double shearCurvature(const PatchPack* packs, int begin, int end, const ConstArrays& d);
double twistCurvature(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& d,
                      const ConstArrays& normals);

/// Adds what the packs have of H⁺ at each of their nodes [N/m], from the last evaluation.
void addEdgeBlocks(const EdgePack* packs, int count, const BlockArrays& blocks);
void addTripleBlocks(const TriplePack* packs, int count, const ConstArrays& normals,
                     const BlockArrays& blocks);
void addShearBlocks(const PatchPack* packs, int count, const BlockArrays& blocks);
void addTwistBlocks(const PatchPack* packs, int count, double rigidity, const ConstArrays& normals,
                    const BlockArrays& blocks);

}  // namespace haptic_cloth
