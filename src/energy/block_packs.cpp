#include "energy/packs.h"

namespace haptic_cloth {

HAPTIC_CLOTH_CLONES void addEdgeBlocks(const EdgePack* packs, int count, const BlockArrays& blocks) {
  for (int p = 0; p < count; ++p) {
    const EdgePack& pack = packs[p];
    const Lanes across = load(pack.across), along = load(pack.along);
    BlockLanes value = (along - across) * square({load(pack.axis_x), load(pack.axis_y), load(pack.axis_z)});
    for (int k = 0; k < 3; ++k) value.entries[k] += across;
    add(blocks, pack.a, value);
    add(blocks, pack.b, value);
  }
}

HAPTIC_CLOTH_CLONES void addTripleBlocks(const TriplePack* packs, int count, const ConstArrays& normals,
                                         const BlockArrays& blocks) {
  for (int p = 0; p < count; ++p) {
    const TriplePack& pack = packs[p];
    const BlockLanes value = load(pack.stiffness) * square(gather(normals, pack.c));
    const Lanes left = load(pack.left), right = load(pack.right), both = left + right;
    add(blocks, pack.l, (left * left) * value);
    add(blocks, pack.r, (right * right) * value);
    add(blocks, pack.c, (both * both) * value);
  }
}

HAPTIC_CLOTH_CLONES void addShearBlocks(const PatchPack* packs, int count, const BlockArrays& blocks) {
  for (int p = 0; p < count; ++p) {
    const PatchPack& pack = packs[p];
    const Lanes stiffness = load(pack.stiffness);
    const BlockLanes rising =
                         stiffness * square({load(pack.rising_x), load(pack.rising_y), load(pack.rising_z)}),
                     falling = stiffness *
                               square({load(pack.falling_x), load(pack.falling_y), load(pack.falling_z)});
    for (const int corner : {0, 3}) add(blocks, pack.corners[corner], rising);
    for (const int corner : {1, 2}) add(blocks, pack.corners[corner], falling);
  }
}

HAPTIC_CLOTH_CLONES void addTwistBlocks(const PatchPack* packs, int count, double rigidity,
                                        const ConstArrays& normals, const BlockArrays& blocks) {
  for (int p = 0; p < count; ++p) {
    const BlockLanes value = twistStiffness(packs[p], rigidity) * square(load(normals, kLanes * p));
    for (const NodeLanes& nodes : packs[p].corners) add(blocks, nodes, value);
  }
}

}  // namespace haptic_cloth
