/// Bending of the triples: E = A ψ(κ), κ = n · bent(x), with the surface normal n at the centre, which is
/// held over a step. A sharp fold that turns away from n would lose energy by that alone. So it also has ½ A
/// (M/κ) |t|², with t the part of bent(x) across n and M/κ that of its start: to second order the energy then
/// does not change as the fold turns.
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

  /// Finds the sharp folds at some positions and how stiffly they keep their direction.
  void holdFolds(const Surface& at);

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

  /// Adds what sharp folds store that have turned away from their normals.
  void addTurned(const Surface& at, ElasticEnergy& sum) const;

  void serialize(Archive& archive);

  /// ψ of one triple [J/m²].
  double density(int triple, const Surface& at) const {
    return loop(triple).stored(step(triple).play, deformation(triple, at));
  }

 private:
  static double curvature(const Triple& t, const Surface& at) {
    return at.normals.node(t.c).dot(t.bent(at.x));
  }

  /// Part of a triple's curvature vector across its normal [1/m].
  Vec3 across(int triple, const Vec3& bent, const SurfaceNormals& normals) const {
    const Vec3 n = normals.node(list_[triple].c);
    return bent - n.dot(bent) * n;
  }
  template <class Visit>
  void forFolds(int begin, int end, const Visit& visit) const;
  void listFolds();

  std::vector<SagittaPack> sagittas_;  ///< see TriplePack
  std::vector<double> held_;           ///< A M/κ of the triples that fold sharply, 0 for others [J m²]
  std::vector<int> folds_;             ///< these triples in the order of their places
};

}  // namespace haptic_cloth
