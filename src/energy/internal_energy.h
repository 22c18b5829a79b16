/// Internal energy of the cloth: stretch, bending, shear and twist of all elements.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "energy/bend_energy.h"
#include "energy/history.h"
#include "energy/shear_energy.h"
#include "energy/stretch_energy.h"
#include "energy/surface_normals.h"
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
  using Energy = ElasticEnergy;

  InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh);

  /// Adapts to a rebuilt mesh. Elements with memory have none that is valid until endChange() and
  /// recall().
  void resize();

  /// Tells whether a law has hysteresis; otherwise commit() has no effect, and a mesh change needs
  /// neither remember() nor recall().
  bool hasMemory() const { return stretch_.hasMemory() || bend_.hasMemory() || shear_.hasMemory(); }

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
  void setNormals(const Field& positions) {
    normals_.update(mesh_, positions);
    bend_.holdFolds(at(positions));
  }

  /// Number of elements; laws that are zero everywhere have none.
  int elements() const { return stretch_.elements() + bend_.elements() + shear_.elements(); }

  /// Number of padded places: length of the range that evaluate() and quadraticForm() divide in
  /// multiples of kPack.
  int size() const { return gather_.firstPatch() + gather_.patches().size(); }

  /// Where the places of each kind and direction begin. Each of these arrays is sorted along the mesh.
  std::array<int, 5> starts() const {
    return {0, gather_.edges().warpEnd(), gather_.firstTriple(),
            gather_.firstTriple() + gather_.triples().warpEnd(), gather_.firstPatch()};
  }

  enum class Kind { Edge, Triple, Patch };

  /// Kind of an element, and its index within its kind.
  std::pair<Kind, int> kind(int element) const {
    if (element < stretch_.elements()) return {Kind::Edge, element};
    element -= stretch_.elements();
    if (element < bend_.elements()) return {Kind::Triple, element};
    return {Kind::Patch, element - bend_.elements()};
  }

  /// Properties of one element: strain [-], curvature [1/m] or shear angle [rad] at x, its law
  /// within the step, and its area [m²].
  double deformation(int element, const Field& x) const;
  Curve::Point law(int element, double deformation) const;
  double area(int element) const;

  /// Surface normals of the step at a node and, with a twist term, of a patch. twist() [N·m] is
  /// zero if there is no such term.
  Vec3 normal(int node) const { return normals_.node(node); }
  ConstArrays nodeNormals() const { return normals_.nodes(); }
  Vec3 patchNormal(int patch) const { return normals_.patch(patch); }
  double twist() const { return shear_.twist(); }

  /// Adds the packs that act on an awake node to `runs`.
  void appendAwake(const std::vector<char>& awake, Runs& runs) const;

  /// Evaluates part begin..end of the range at `x`, and stores forces and stiffness. @return its
  /// energy
  Energy evaluate(int begin, int end, const Field& x);

  /// Quadratic form d · H⁺ d of that part at the last evaluation.
  double quadraticForm(int begin, int end, const Field& d) const;

  /// Adds the energy gradient [N] at nodes begin..end. @pre begin is a multiple of kPack
  void addGradient(int begin, int end, Field& gradient) const { gather_.add(begin, end, slots_, gradient); }
  const NodeGather& gather() const { return gather_; }

  /// Adds blocks of H⁺ [N/m] at all nodes, from the last evaluation, for part `part` of `parts`
  /// equal parts of the elements.
  void addBlocks(int part, int parts, BlockField& blocks) const;

  /// Values for display at positions `x`: largest |ε| of the edges, and values of one element.
  double maxStrain(const Field& x) const;
  double tension(int edge, const Field& x) const {  ///< [N/m]
    return stretch_.law(edge, stretch_.deformation(edge, at(x))).force;
  }
  /// Curvature of one triple [1/m], and its ψ [J/m²].
  double curvature(int triple, const Field& x) const { return bend_.deformation(triple, at(x)); }
  double bendingDensity(int triple, const Field& x) const { return bend_.density(triple, at(x)); }

 private:
  template <class Self, class Visit>
  static void forRuns(Self& self, int begin, int end, const Visit& visit);

  Surface at(const Field& x) const { return {x, normals_}; }
  Surface before() const { return {change_.positions(), before_normals_}; }

  const ActiveMesh& mesh_;
  StretchEnergy stretch_;
  BendEnergy bend_;
  ShearEnergy shear_;
  SurfaceNormals normals_;
  SurfaceNormals before_normals_;  ///< normals before a change of the mesh
  MeshChange change_;              ///< last change of the mesh
  NodeGather gather_;
  Field slots_;  ///< see NodeGather; [N], for triples [N·m²]
};

}  // namespace haptic_cloth
