/// Shear of the patches: E = A ψ(γ) with the shear angle γ (shear.h), and their twist (twist.h),
/// which counts as bending.
#pragma once

#include "energy/element_energy.h"
#include "energy/history.h"
#include "energy/shear.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Verbs: see ElementEnergy. The slots are those of the rising sides of the patches, their falling
/// sides and their twists.
class ShearEnergy : public ElementEnergy<ShearEnergy, Patch, PatchPack> {
 public:
  /// @param twist_rigidity [N·m]; zero if there is no such term
  ShearEnergy(const Loop& law, double twist_rigidity, const ActiveMesh& mesh);

  double twist() const { return twist_; }

  void resize(const PackedRange& places);
  void evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots, ElasticEnergy& sum);
  void addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& normals, double& sum) const;
  void addBlocks(int begin, int end, const SurfaceNormals& normals, BlockField& blocks) const;
  void remember(const Surface& at, ForceHistory& history) const;
  void recall(const Followed<Patch>& change, const Surface& at, ForceHistory& history);

  double area(int patch) const { return list_[patch].area; }
  double deformation(int patch, const Surface& at) const {
    return Shear(corners(list_[patch], at.x), list_[patch].area).angle();
  }
  void deformations(int pack, const Surface& at, double* values) const;
  static bool touches(const PatchPack& pack, const char* flags);
  void addEnergy(const Patch& patch, int k, const Loop& law, double play, const Surface& at,
                 ElasticEnergy& sum) const;

 private:
  double twist_;  ///< rigidity [N·m]
};

}  // namespace haptic_cloth
