#include "energy/shear_energy.h"

#include "energy/twist.h"
#include "simd/kernels.h"

namespace haptic_cloth {

ShearEnergy::ShearEnergy(const Loop& law, double twist_rigidity, const ActiveMesh& mesh)
    : ElementEnergy(mesh, mesh.patches, {law}), twist_(twist_rigidity) {}

void ShearEnergy::resize(const PackedRange& places) {
  startPacks(places);
  for (int p = 0; p < packs(); ++p) packs_[p].corners = mesh_.patch_corners[p];
  for (int k = 0; k < elements(); ++k) packs_[k / kPack].area[k % kPack] = list_[k].area;
}

void ShearEnergy::evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots,
                           ElasticEnergy& sum) {
  const int side = places_.size();
  if (!isZero()) {
    sum.shear += kernels().evaluateShears(packs_.data(), run.begin, run.end, tables_.front().view(),
                                          memory_.packs(), at.x.arrays(), slots, run.slot, side);
  }
  if (twist_ > 0.0) {
    sum.bend += kernels().evaluateTwists(packs_.data(), run.begin, run.end, twist_, at.x.arrays(),
                                         at.normals.patches(), slots, run.slot + 2 * side);
  }
}

void ShearEnergy::addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& normals,
                                   double& sum) const {
  if (!isZero()) sum += kernels().shearQuadraticForm(packs_.data(), run.begin, run.end, d.arrays());
  if (twist_ > 0.0) {
    sum += kernels().twistQuadraticForm(packs_.data(), run.begin, run.end, twist_, d.arrays(),
                                        normals.patches());
  }
}

void ShearEnergy::addBlocks(int begin, int end, const SurfaceNormals& normals, BlockField& blocks) const {
  if (!isZero()) kernels().addShearBlocks(packs_.data(), begin, end, blocks.arrays());
  if (twist_ > 0.0) {
    kernels().addTwistBlocks(packs_.data(), begin, end, twist_, normals.patches(), blocks.arrays());
  }
}

void ShearEnergy::remember(const Surface& at, ForceHistory& history) const {
  for (int k = 0; memory_.packs() && k < elements(); ++k) {
    history.shear(list_[k].cell) = loop(k).force(step(k).play, deformation(k, at));
  }
}

void ShearEnergy::recall(const Followed<Patch>& change, const Surface& at, ForceHistory& history) {
  for (int k = 0; memory_.packs() && k < elements(); ++k) {
    if (change.isNew(k)) setPlay(k, loop(k).playFor(history.shear(list_[k].cell), deformation(k, at)));
  }
}

void ShearEnergy::deformations(int pack, const Surface& at, double* values) const {
  kernels().shearAngles(packs_.data(), pack, pack + 1, at.x.arrays(), values);
}

bool ShearEnergy::touches(const PatchPack& pack, const char* flags) {
  return std::any_of(std::begin(pack.corners.at), std::end(pack.corners.at),
                     [flags](const PackIndices& nodes) { return nodes.anyOf(flags); });
}

void ShearEnergy::addEnergy(const Patch& patch, int k, const Loop& law, double play, const Surface& at,
                            ElasticEnergy& sum) const {
  const auto x = corners(patch, at.x);
  sum.shear += patch.area * law.stored(play, Shear(x, patch.area).angle());
  if (twist_ > 0.0) sum.bend += evaluateTwist(x, at.normals.patch(k), twist_, patch.area).energy;
}

}  // namespace haptic_cloth
