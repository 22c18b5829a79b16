#include "energy/twist_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {
namespace {

/// Symmetric 3 × 3 matrices, entries in the order of BlockArrays.
struct BlockLanes {
  Lanes entry[6];
};

HAPTIC_CLOTH_INLINE BlockLanes square(const Lanes3& a) {
  return {{a.x * a.x, a.y * a.y, a.z * a.z, a.y * a.z, a.x * a.z, a.x * a.y}};
}
HAPTIC_CLOTH_INLINE BlockLanes operator*(const Lanes& s, const BlockLanes& m) {
  const Lanes(&e)[6] = m.entry;
  return {{s * e[0], s * e[1], s * e[2], s * e[3], s * e[4], s * e[5]}};
}

/// Adds to the blocks of nodes, some of which may be equal.
HAPTIC_CLOTH_INLINE void add(const BlockArrays& blocks, const PackIndices& nodes, int lane,
                             const BlockLanes& value) {
  if (inRow(nodes, lane)) {
    for (int k = 0; k < 6; ++k) {
      double* const at = blocks.entry[k] + nodes.index[lane];
      store(at, load(at) + value.entry[k]);
    }
    return;
  }
  for (int k = 0; k < 6; ++k) {
    double one[kLanes];
    store(one, value.entry[k]);
    for (int l = 0; l < kLanes; ++l) blocks.entry[k][nodes.index[lane + l]] += one[l];
  }
}

}  // namespace

void addEdgeBlocks(const EdgePack* packs, int begin, int end, const BlockArrays& blocks) {
  for (int p = begin; p < end; ++p) {
    const EdgePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes across = load(pack.across + l), along = load(pack.along + l);
      const Lanes3 axis{load(pack.axis_x + l), load(pack.axis_y + l), load(pack.axis_z + l)};
      BlockLanes value = (along - across) * square(axis);
      for (int k = 0; k < 3; ++k) value.entry[k] += across;
      add(blocks, pack.a, l, value);
      add(blocks, pack.b, l, value);
    }
  }
}

void addTripleBlocks(const TriplePack* packs, const SagittaPack* sagittas, int begin, int end,
                     const ConstArrays& normals, const BlockArrays& blocks) {
  for (int p = begin; p < end; ++p) {
    const TriplePack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const BlockLanes value = load(pack.stiffness + l) * square(gather(normals, pack.c, l));
      const Lanes left = load(pack.left + l), right = load(pack.right + l);
      Lanes centre = left + right;
      if (pack.sagitta >= 0) {
        const SagittaPack& beside = sagittas[pack.sagitta];
        const Lanes coefficient = load(beside.coefficient + l);
        centre -= 2.0 * coefficient;
        add(blocks, beside.a, l, (coefficient * coefficient) * value);
        add(blocks, beside.b, l, (coefficient * coefficient) * value);
      }
      add(blocks, pack.l, l, (left * left) * value);
      add(blocks, pack.r, l, (right * right) * value);
      add(blocks, pack.c, l, (centre * centre) * value);
    }
  }
}

void addShearBlocks(const PatchPack* packs, int begin, int end, const BlockArrays& blocks) {
  for (int p = begin; p < end; ++p) {
    const PatchPack& pack = packs[p];
    for (int l = 0; l < kPack; l += kLanes) {
      const Lanes stiffness = load(pack.stiffness + l);
      const BlockLanes rising = stiffness * square({load(pack.rising_x + l), load(pack.rising_y + l),
                                                    load(pack.rising_z + l)}),
                       falling = stiffness * square({load(pack.falling_x + l), load(pack.falling_y + l),
                                                     load(pack.falling_z + l)});
      add(blocks, pack.corners.at[0], l, rising);
      add(blocks, pack.corners.at[3], l, rising);
      add(blocks, pack.corners.at[1], l, falling);
      add(blocks, pack.corners.at[2], l, falling);
    }
  }
}

void addTwistBlocks(const PatchPack* packs, int begin, int end, double rigidity, const ConstArrays& normals,
                    const BlockArrays& blocks) {
  for (int p = begin; p < end; ++p) {
    for (int l = 0; l < kPack; l += kLanes) {
      const BlockLanes value = twistStiffness(packs[p], l, rigidity) * square(load(normals, kPack * p + l));
      for (int corner = 0; corner < 4; ++corner) add(blocks, packs[p].corners.at[corner], l, value);
    }
  }
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
