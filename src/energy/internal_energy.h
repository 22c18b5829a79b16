/// Elastic energy of the cloth over the active lists: stretch, bend and shear.
#pragma once

#include <utility>
#include <vector>

#include "energy/history.h"
#include "haptic_cloth/fabric.h"
#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Elements are numbered in one range: edges, triples, patches. Each leaves its force in slots of its own,
/// which the nodes then gather in a fixed order, so any split of the range over threads gives the same bits.
class InternalEnergy {
 public:
  struct Energy {
    double stretch = 0.0, bend = 0.0, shear = 0.0;  ///< [J]
  };

  explicit InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh);

  /// Adjusts to a rebuilt mesh; laws with memory wait for recall().
  void resize();

  /// True where a law has hysteresis; else the three calls below do nothing.
  bool hasMemory() const { return hasMemory(stretch_) || hasMemory(bend_) || shear_.hasMemory(); }

  /// Makes the end of an accepted step, elements begin..end, part of the fabric's history.
  void commit(int begin, int end, const std::vector<Vec3>& x);

  /// Writes forces down before a change of the mesh, and reads them after resize() and setNormals().
  void remember(const std::vector<Vec3>& x, ForceHistory& history) const;
  void recall(const std::vector<Vec3>& x, ForceHistory& history);

  /// Energy the elements could give back. Without memory the same as evaluate()'s sum.
  Energy stored(const std::vector<Vec3>& x) const;

  /// Takes the surface normals for a step; triples bend about them until the next call.
  void setNormals(const std::vector<Vec3>& positions);

  /// Number of elements; laws that are zero everywhere count none.
  int size() const { return edge_count_ + triple_count_ + patch_count_; }

  enum class Kind { Edge, Triple, Patch };

  /// What element k of the range is, and its index among its kind.
  std::pair<Kind, int> kind(int element) const {
    if (element < edge_count_) return {Kind::Edge, element};
    element -= edge_count_;
    if (element < triple_count_) return {Kind::Triple, element};
    return {Kind::Patch, element - triple_count_};
  }

  /// Of one element of the range: strain [-], curvature [1/m] or shear angle [rad] at x, its law within the
  /// step, and the area [m²] it stands for.
  double deformation(int element, const std::vector<Vec3>& x) const;
  Curve::Point law(int element, double deformation) const;
  double area(int element) const;

  /// The step's surface normals at a node and of a patch; twist() [N·m] is zero where there is no such term.
  const Vec3& normal(int node) const { return node_normals_[node]; }
  const Vec3& patchNormal(int patch) const { return patch_normals_[patch]; }
  double twist() const { return twist_rigidity_; }

  /// Energy of elements begin..end at `x`; leaves forces and stiffness in their slots.
  Energy evaluate(int begin, int end, const std::vector<Vec3>& x);

  /// d · H⁺ d of elements begin..end at the last evaluation.
  double curvature(int begin, int end, const std::vector<Vec3>& d) const;

  /// Adds the energy gradient [N] at a node.
  void addGradient(int node, Vec3& gradient) const {
    for (int e = mesh_.rows[node]; e < mesh_.rows[node + 1]; ++e) {
      gradient += mesh_.incidences[e].coefficient * slots_[mesh_.incidences[e].slot];
    }
  }

  /// Diagonal of H⁺ [N/m] at all nodes, added to `diagonal`, from the last evaluation.
  void addDiagonal(std::vector<Vec3>& diagonal) const;

  /// For display, at positions `x`: largest |ε| of the edges, and values of one element.
  double maxStrain(const std::vector<Vec3>& x) const;
  double tension(int edge, const std::vector<Vec3>& x) const;           ///< [N/m]
  double curvature(int triple, const std::vector<Vec3>& x) const;       ///< of one triple [1/m]
  double bendingDensity(int triple, const std::vector<Vec3>& x) const;  ///< ψ_b of one triple [J/m²]

 private:
  struct EdgeTangent {
    Vec3 axis;
    double along, across;
  };
  struct PatchTangent {
    Vec3 rising, falling;
    double stiffness;
  };

  double evaluateEdges(int begin, int end, const std::vector<Vec3>& x);
  double evaluateTriples(int begin, int end, const std::vector<Vec3>& x);
  double evaluatePatches(int begin, int end, const std::vector<Vec3>& x);
  double evaluateTwists(int begin, int end, const std::vector<Vec3>& x);
  std::array<Vec3, 4> corners(int patch, const std::vector<Vec3>& x) const {
    const auto& n = mesh_.patches[patch].nodes;
    return {x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
  }
  double strain(int edge, const std::vector<Vec3>& x) const;
  void recallEdges(const std::vector<Vec3>& x, ForceHistory& history);
  double shearAngle(int patch, const std::vector<Vec3>& x) const;
  static bool hasMemory(const std::array<Loop, 2>& laws) {
    return laws[kWarp].hasMemory() || laws[kWeft].hasMemory();
  }

  /// Calls edge(e), triple(t), patch(k) for elements begin..end.
  template <class OnEdge, class OnTriple, class OnPatch>
  void forEach(int begin, int end, OnEdge edge, OnTriple triple, OnPatch patch) const;

  const ActiveMesh& mesh_;
  std::array<Loop, 2> stretch_, bend_;
  Loop shear_;
  double twist_rigidity_;  ///< [N·m]
  bool bends_, shears_;
  int edge_count_ = 0, triple_count_ = 0, patch_count_ = 0;
  std::vector<Vec3> node_normals_;
  std::vector<Vec3> patch_normals_;  ///< empty without a twist term
  std::vector<Vec3> slots_;          ///< see ActiveMesh::slots(); [N], of triples [N·m²]
  std::vector<EdgeTangent> edge_tangents_;
  std::vector<double> triple_stiffness_;
  std::vector<PatchTangent> patch_tangents_;
  std::vector<Loop::Step> edge_steps_, triple_steps_, patch_steps_;  ///< empty where no law has memory
};

}  // namespace haptic_cloth
