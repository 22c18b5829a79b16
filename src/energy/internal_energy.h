/// Internal energy of the cloth: stretch, bending, shear and twist of all elements.
#pragma once

#include <utility>
#include <vector>

#include "energy/history.h"
#include "energy/law_table.h"
#include "energy/packs.h"
#include "haptic_cloth/fabric.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "mesh/mesh_change.h"
#include "mesh/node_gather.h"
#include "parallel/runs.h"

namespace haptic_cloth {

/// Energy of all elements. They are numbered in one range: edges, triples, patches. Kernels run
/// over them in packs (packs.h); each element writes its force to slots of its own, which the nodes
/// gather in a fixed order (node_gather.h). So any division of the work over threads gives the same
/// bits.
class InternalEnergy {
 public:
  struct Energy {
    double stretch = 0.0, bend = 0.0, shear = 0.0;  ///< [J]
  };

  InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh);

  /// Adapts to a rebuilt mesh. Elements with memory have none that is valid until endChange() and
  /// recall().
  void resize();

  /// Tells whether a law has hysteresis; otherwise commit() has no effect, and a mesh change needs
  /// neither remember() nor recall().
  bool hasMemory() const { return hasMemory(stretch_) || hasMemory(bend_) || shear_.hasMemory(); }

  /// Commits the end of an accepted step to the memory of elements begin..end of 0..size().
  void commit(int begin, int end, const Field& x);

  /// Enclose a change of the mesh, with resize() and setNormals() before endChange(). Surviving
  /// elements keep their memory; all others wait for recall().
  void beginChange(const Field& x);
  void endChange(const Field& x);

  /// Energy of the new elements minus that of the removed ones [J], without the effect of the
  /// change on surface normals.
  double madeByChange(const Field& x) const;

  /// Record forces before a change of the mesh, and give them to the new elements after it.
  void remember(const Field& x, ForceHistory& history) const;
  void recall(const Field& x, ForceHistory& history);

  /// Saves or loads the memory of the elements and the normals of the last step, which mesh
  /// decisions use. @pre loading: resize() and setNormals()
  void serialize(Archive& archive);

  /// Energy that the elements could give back. Without memory it equals the sum of evaluate().
  Energy stored(const Field& x) const;

  /// Sets the surface normals, which are held until the next call.
  void setNormals(const Field& positions);

  /// Number of elements; laws that are zero everywhere have none.
  int elements() const { return edge_count_ + triple_count_ + patch_count_; }

  /// Number of padded places: length of the range that evaluate() and curvature() divide in
  /// multiples of kPack.
  int size() const { return gather_.firstPatch() + gather_.patches().size(); }

  enum class Kind { Edge, Triple, Patch };

  /// Kind of an element, and its index within its kind.
  std::pair<Kind, int> kind(int element) const {
    if (element < edge_count_) return {Kind::Edge, element};
    element -= edge_count_;
    if (element < triple_count_) return {Kind::Triple, element};
    return {Kind::Patch, element - triple_count_};
  }

  /// Properties of one element: strain [-], curvature [1/m] or shear angle [rad] at x, its law
  /// within the step, and its area [m²].
  double deformation(int element, const Field& x) const;
  Curve::Point law(int element, double deformation) const;
  double area(int element) const;

  /// Surface normals of the step at a node and, with a twist term, of a patch. twist() [N·m] is
  /// zero if there is no such term.
  Vec3 normal(int node) const { return node_normals_[node]; }
  Vec3 patchNormal(int patch) const { return patch_normals_[patch]; }
  double twist() const { return twist_rigidity_; }

  /// Adds the packs that act on an awake node to `runs`.
  void appendAwake(const std::vector<char>& awake, Runs& runs) const;

  /// Evaluates part begin..end of the range at `x`, and stores forces and stiffness. @return its
  /// energy
  Energy evaluate(int begin, int end, const Field& x);

  /// Quadratic form d · H⁺ d of that part at the last evaluation.
  double curvature(int begin, int end, const Field& d) const;

  /// Adds the energy gradient [N] at nodes begin..end. @pre begin is a multiple of kPack
  void addGradient(int begin, int end, Field& gradient) const { gather_.add(begin, end, slots_, gradient); }
  const NodeGather& gather() const { return gather_; }

  /// Adds blocks of H⁺ [N/m] at all nodes, from the last evaluation, for part `part` of `parts`
  /// equal parts of the elements.
  void addBlocks(int part, int parts, BlockField& blocks) const;

  /// Values for display at positions `x`: largest |ε| of the edges, and values of one element.
  double maxStrain(const Field& x) const;
  double tension(int edge, const Field& x) const;           ///< [N/m]
  double curvature(int triple, const Field& x) const;       ///< curvature of one triple [1/m]
  double bendingDensity(int triple, const Field& x) const;  ///< ψ_b of one triple [J/m²]

 private:
  /// Memory of the elements of one kind, by their place in the packs; empty if their law has none.
  class Steps {
   public:
    void reserve(int places) { packs_.reserve(places / kPack + 2); }
    void resize(int places) { packs_.resize(places / kPack); }
    Loop::Step get(int place) const {
      return packs_.empty() ? Loop::Step{} : packs_[place / kPack].get(place % kPack);
    }
    void set(int place, const Loop::Step& step) { packs_[place / kPack].set(place % kPack, step); }
    StepPack& pack(int pack) { return packs_[pack]; }
    const StepPack* packs() const { return packs_.empty() ? nullptr : packs_.data(); }
    void serialize(Archive& archive);

   private:
    std::vector<StepPack> packs_;
  };

  /// State before a change of the mesh that MeshChange does not record.
  struct Before {
    PackedRange edge_places, triple_places;
    Steps edges, triples, patches;
    Field normals, patch_normals;
  };

  /// Parts of begin..end that belong to edges and triples of both directions and to patches, in
  /// packs.
  struct Parts {
    std::array<std::pair<int, int>, 2> edges, triples;
    std::pair<int, int> patches;
  };
  Parts split(int begin, int end) const;

  void packEdges();
  void packTriples();
  void packPatches();
  void forgetAll();
  Loop::Step edgeStep(int edge) const { return edge_steps_.get(gather_.edges().place(edge)); }
  Loop::Step tripleStep(int triple) const { return triple_steps_.get(gather_.triples().place(triple)); }
  Loop::Step patchStep(int patch) const { return patch_steps_.get(patch); }
  double strain(int edge, const Field& x) const;
  void recallEdges(const Field& x, ForceHistory& history);
  double shearAngle(int patch, const Field& x) const;
  static bool hasMemory(const std::array<Loop, 2>& laws) {
    return laws[kWarp].hasMemory() || laws[kWeft].hasMemory();
  }

  /// Axis of twist of a patch; zero if there is no such term.
  Vec3 twistAxis(const Field& patch_normals, int patch) const {
    return twist_rigidity_ > 0.0 ? patch_normals[patch] : Vec3(Vec3::Zero());
  }

  /// Energy that one element could give back.
  double stored(const Edge& edge, double play, const Field& x) const;
  double stored(const Triple& triple, double play, const Vec3& normal, const Field& x) const;
  Energy stored(const Patch& patch, double play, const Vec3& normal, const Field& x) const;

  /// Calls edge(e), triple(t), patch(k) for elements begin..end.
  template <class OnEdge, class OnTriple, class OnPatch>
  void forEach(int begin, int end, OnEdge edge, OnTriple triple, OnPatch patch) const;

  const ActiveMesh& mesh_;
  std::array<Loop, 2> stretch_, bend_;
  Loop shear_;
  std::array<LawTable, 2> stretch_tables_, bend_tables_;
  LawTable shear_table_;
  double twist_rigidity_;  ///< [N·m]
  /// shears_: patches have an effect, possibly twist alone.
  bool bends_, shears_;
  NodeGather gather_;
  int edge_count_ = 0, triple_count_ = 0, patch_count_ = 0;
  Field node_normals_;
  Field patch_normals_;  ///< unit vectors only with a twist term
  Field slots_;          ///< see NodeGather; [N], for triples [N·m²]
  std::vector<EdgePack> edge_packs_;
  std::vector<TriplePack> triple_packs_;
  std::vector<PatchPack> patch_packs_;
  std::vector<double> edge_loads_;                 ///< scratch of recallEdges() [N]
  Steps edge_steps_, triple_steps_, patch_steps_;  ///< empty if no law has memory
  MeshChange change_;                              ///< last change of the mesh
  Before before_;
};

}  // namespace haptic_cloth
