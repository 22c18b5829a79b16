/// Bending of the triples: E = A ψ(κ), κ = n · bent(x), with the surface normal n at the centre.
#pragma once

#include <array>

#include "energy/element_energy.h"
#include "energy/history.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Verbs: see ElementEnergy.
class BendEnergy : public ElementEnergy<BendEnergy, Triple, TriplePack> {
 public:
  BendEnergy(const std::array<Loop, 2>& laws, const ActiveMesh& mesh);

  void resize(const PackedRange& places);
  void evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots, ElasticEnergy& sum);
  void addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& normals, double& sum) const;
  void addBlocks(int begin, int end, const SurfaceNormals& normals, BlockField& blocks) const;
  void remember(const Surface& at, ForceHistory& history) const;
  void recall(const Followed<Triple>& change, ForceHistory& history);

  double area(int triple) const { return list_[triple].area; }
  double deformation(int triple, const Surface& at) const { return curvature(list_[triple], at); }
  void deformations(int pack, const Surface& at, double* values) const;
  bool touches(const TriplePack& pack, const char* flags) const;
  void addEnergy(const Triple& triple, int k, const Loop& law, double play, const Surface& at,
                 ElasticEnergy& sum) const;

  /// ψ of one triple [J/m²].
  double density(int triple, const Surface& at) const {
    return loop(triple).stored(step(triple).play, deformation(triple, at));
  }

 private:
  static double curvature(const Triple& t, const Surface& at) {
    return at.normals.node(t.c).dot(t.bent(at.x));
  }

  std::vector<SagittaPack> sagittas_;  ///< see TriplePack
};

}  // namespace haptic_cloth
