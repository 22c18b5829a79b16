/// Table of kernels: loops over packs, compiled once for each instruction set.
#pragma once

#include "simd/pack.h"

namespace haptic_cloth {

struct ContactEnergy;
struct EdgePack;
struct GatherColumn;
struct GatherDetail;
struct LawView;
struct Motion;
struct DragPack;
struct PairBound;
struct PairContext;
struct PairLimits;
struct StraightWay;
struct PairPack;
struct PatchCorners;
struct PatchPack;
struct SagittaPack;
struct SampleContext;
struct SolidMotion;
struct SamplePack;
struct SolidLanes;
struct StepPack;
struct TriplePack;

/// Calls KERNEL(result, name, arguments) for each kernel. The kernels are described beside their
/// data: energy/packs.h, contact/sample_packs.h, contact/pair_packs.h,
/// mesh/node_gather.h (NodeGather::add) and
/// sim/motion.h; those of the preconditioner in sim/precondition_kernels.cpp.
#define HAPTIC_CLOTH_KERNELS(KERNEL)                                                                         \
  KERNEL(double, evaluateEdges,                                                                              \
         (EdgePack * packs, int begin, int end, const LawView& law, const StepPack* steps,                   \
          const ConstArrays& x, const MutableArrays& slots, int first))                                      \
  KERNEL(double, evaluateTriples,                                                                            \
         (TriplePack * packs, const SagittaPack* sagittas, int begin, int end, const LawView& law,           \
          const StepPack* steps, const ConstArrays& x, const ConstArrays& normals,                           \
          const MutableArrays& slots, int first))                                                            \
  KERNEL(double, evaluateShears,                                                                             \
         (PatchPack * packs, int begin, int end, const LawView& law, const StepPack* steps,                  \
          const ConstArrays& x, const MutableArrays& slots, int first, int stride))                          \
  KERNEL(double, evaluateTwists,                                                                             \
         (const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& x,                 \
          const ConstArrays& normals, const MutableArrays& slots, int first))                                \
  KERNEL(void, edgeStrains,                                                                                  \
         (const EdgePack* packs, int begin, int end, const ConstArrays& x, double* strains))                 \
  KERNEL(void, tripleCurvatures,                                                                             \
         (const TriplePack* packs, const SagittaPack* sagittas, int begin, int end, const ConstArrays& x,    \
          const ConstArrays& normals, double* curvatures))                                                   \
  KERNEL(void, shearAngles,                                                                                  \
         (const PatchPack* packs, int begin, int end, const ConstArrays& x, double* angles))                 \
  KERNEL(void, patchNormals,                                                                                 \
         (const PatchCorners* corners, int count, const ConstArrays& x, const MutableArrays& normals))       \
  KERNEL(void, normalise, (int count, const MutableArrays& vectors))                                         \
  KERNEL(double, edgeQuadraticForm, (const EdgePack* packs, int begin, int end, const ConstArrays& d))       \
  KERNEL(double, tripleQuadraticForm,                                                                        \
         (const TriplePack* packs, const SagittaPack* sagittas, int begin, int end, const ConstArrays& d,    \
          const ConstArrays& normals))                                                                       \
  KERNEL(double, shearQuadraticForm, (const PatchPack* packs, int begin, int end, const ConstArrays& d))     \
  KERNEL(double, twistQuadraticForm,                                                                         \
         (const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& d,                 \
          const ConstArrays& normals))                                                                       \
  KERNEL(void, addEdgeBlocks, (const EdgePack* packs, int begin, int end, const BlockArrays& blocks))        \
  KERNEL(void, addTripleBlocks,                                                                              \
         (const TriplePack* packs, const SagittaPack* sagittas, int begin, int end,                          \
          const ConstArrays& normals, const BlockArrays& blocks))                                            \
  KERNEL(void, addShearBlocks, (const PatchPack* packs, int begin, int end, const BlockArrays& blocks))      \
  KERNEL(void, addTwistBlocks,                                                                               \
         (const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& normals,           \
          const BlockArrays& blocks))                                                                        \
  KERNEL(void, gatherColumns,                                                                                \
         (const int* groups, const GatherColumn* columns, const GatherDetail* details, int begin, int end,   \
          const ConstArrays& slots, const MutableArrays& nodes))                                             \
  KERNEL(double, evaluateMotion,                                                                             \
         (const Motion& motion, int begin, int end, const ConstArrays& x, const MutableArrays& gradient))    \
  KERNEL(double, motionQuadraticForm, (const Motion& motion, int begin, int end, const ConstArrays& d))      \
  KERNEL(ContactEnergy, evaluateSamples,                                                                     \
         (SamplePack * packs, int begin, int end, const SampleContext& context, const ConstArrays& x,        \
          const MutableArrays& slots, int first))                                                            \
  KERNEL(double, sampleQuadraticForm,                                                                        \
         (const SamplePack* packs, int begin, int end, const ConstArrays& d, const SolidMotion& moves,       \
          double slip, bool whole_motion))                                                                   \
  KERNEL(double, largestStep,                                                                                \
         (const SamplePack* packs, int begin, int end, double share, double firm, const ConstArrays& d,      \
          const SolidMotion& moves))                                                                         \
  KERNEL(void, solidDistances,                                                                               \
         (const SolidLanes& solid, int count, const ConstArrays& x, double* distances,                       \
          const MutableArrays& normals))                                                                     \
  KERNEL(void, patchMargins,                                                                                 \
         (const PatchCorners* corners, int count, double range, const ConstArrays& x, const double* reach,   \
          const double* gaps, const ConstArrays& normals, double* margins))                                  \
  KERNEL(double, evaluatePairs,                                                                              \
         (PairPack * packs, PairBound * bounds, int begin, int end, const PairContext& context,              \
          const ConstArrays& x))                                                                             \
  KERNEL(double, pairQuadraticForm,                                                                          \
         (const PairPack* packs, const PairBound* bounds, int begin, int end, const ConstArrays& d))         \
  KERNEL(double, evaluateDrags, (DragPack * packs, int begin, int end, double slip, const ConstArrays& x))   \
  KERNEL(double, dragQuadraticForm,                                                                          \
         (const DragPack* packs, int begin, int end, double slip, const ConstArrays& d))                     \
  KERNEL(double, largestPairStep,                                                                            \
         (PairPack * packs, PairBound * bounds, int begin, int end, const PairLimits& limits,                \
          double travelled, const ConstArrays& x, const ConstArrays& d))                                     \
  KERNEL(int, firstPassing,                                                                                  \
         (const PairPack* packs, const PairBound* bounds, int begin, int end, const StraightWay& way))       \
  KERNEL(double, measurePairs,                                                                               \
         (PairPack * packs, PairBound * bounds, int begin, int end, double travelled, double least,          \
          const ConstArrays& x))                                                                             \
  KERNEL(void, loadPoints, (const double* gradient, int free, int begin, int end, float* values))            \
  KERNEL(void, addOwnBlocks,                                                                                 \
         (const BlockArrays& own, const double* gradient, const float* values, int free, int begin, int end, \
          double* z))

struct Kernels {
#define HAPTIC_CLOTH_MEMBER(result, name, arguments) result(*name) arguments;
  HAPTIC_CLOTH_KERNELS(HAPTIC_CLOTH_MEMBER)
#undef HAPTIC_CLOTH_MEMBER
};

/// Kernels of the instruction set in use (path.h), chosen at the first call.
/// @throws InputError if HAPTIC_CLOTH_SIMD names a set that is unknown or that this machine lacks
const Kernels& kernels();

}  // namespace haptic_cloth

#ifdef HAPTIC_CLOTH_PATH
namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
#define HAPTIC_CLOTH_DECLARE(result, name, arguments) result name arguments;
HAPTIC_CLOTH_KERNELS(HAPTIC_CLOTH_DECLARE)
#undef HAPTIC_CLOTH_DECLARE
}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
#endif
