/// Stretch of the edges: E = A ψ(ε), ε = |b - a|/l₀ - 1.
#pragma once

#include <array>
#include <vector>

#include "energy/element_energy.h"
#include "energy/history.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Verbs: see ElementEnergy.
class StretchEnergy : public ElementEnergy<StretchEnergy, Edge, EdgePack> {
 public:
  StretchEnergy(const std::array<Loop, 2>& laws, const ActiveMesh& mesh);

  void resize(const PackedRange& places);
  void evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots, ElasticEnergy& sum);
  void addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& normals, double& sum) const;
  void addBlocks(int begin, int end, const SurfaceNormals& normals, BlockField& blocks) const;
  void remember(const Surface& at, ForceHistory& history) const;
  void recall(const Followed<Edge>& change, const Surface& at, ForceHistory& history);

  double area(int edge) const { return list_[edge].length * list_[edge].width; }
  double deformation(int edge, const Surface& at) const { return strain(list_[edge], at.x); }
  void deformations(int pack, const Surface& at, double* values) const;
  static bool touches(const EdgePack& pack, const char* flags);
  void addEnergy(const Edge& edge, int k, const Loop& law, double play, const Surface& at,
                 ElasticEnergy& sum) const;

 private:
  static double strain(const Edge& edge, const Field& x) {
    return (x[edge.b] - x[edge.a]).norm() / edge.length - 1.0;
  }

  std::vector<double> loads_;  ///< scratch of recall() [N]
};

}  // namespace haptic_cloth
