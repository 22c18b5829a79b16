/// Common base of the energies of stretch, bending and shear.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "energy/element_memory.h"
#include "energy/law_table.h"
#include "energy/surface_normals.h"
#include "mesh/active_mesh.h"
#include "mesh/mesh_change.h"
#include "mesh/node_gather.h"
#include "parallel/runs.h"

namespace haptic_cloth {

struct ElasticEnergy {
  double stretch = 0.0, bend = 0.0, shear = 0.0;  ///< [J]

  double total() const { return stretch + bend + shear; }
};

/// Consecutive packs of elements of one kind and one direction.
struct PackRun {
  int begin, end;
  int direction;  ///< index of the law
  int slot;       ///< first slot of its forces
};

/// Energy of all elements of one kind: their laws, packs and memory. An element has an area A [m²]
/// and a deformation s (strain [-], curvature [1/m] or shear angle [rad]). Its energy is A ψ(s).
///
/// Kind, the class that derives from this one, supplies the geometry:
///   area(), deformation()  of one element
///   deformations()         of a pack, by the kernels
///   touches()              tells whether a node of a pack has its flag set
///   addEnergy()            adds the energy that one element could give back
/// and the verbs that call kernels or know the mesh:
///   resize()               adapts to a rebuilt mesh; new elements have no memory until recall()
///   evaluate()             stores forces and stiffness of a run, and adds its energy
///   addQuadraticForm()         adds the quadratic form d · H⁺ d of a run at the last evaluation
///   addBlocks()            adds the blocks of H⁺ of packs begin..end at their nodes
///   remember(), recall()   record forces before a mesh change, and give them to new elements
template <class Kind, class Element, class Pack>
class ElementEnergy {
 public:
  /// Number of elements; a kind whose laws are all zero has none.
  int elements() const { return places_.count(); }
  int packs() const { return static_cast<int>(packs_.size()); }

  bool isZero() const {
    return std::all_of(laws_.begin(), laws_.end(), [](const Loop& law) { return law.isZero(); });
  }
  bool hasMemory() const {
    return std::any_of(laws_.begin(), laws_.end(), [](const Loop& law) { return law.hasMemory(); });
  }

  /// Law of one element within the step.
  Curve::Point law(int element, double deformation) const {
    return loop(element)(step(element), deformation);
  }

  /// Adds the packs that act on an awake node to `runs`. @param first place of the first pack
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
    for (const Pack& pack : packs_) {
      if (kind().touches(pack, awake.data())) runs.add(first, first + kPack);
      first += kPack;
    }
  }

  /// Makes the memory of all elements that of a fabric which was never deformed.
  void forget() {
    for (int k = 0; hasMemory() && k < elements(); ++k) setPlay(k, loop(k).initialPlay());
  }

  /// Commits the end of an accepted step to the memory.
  void commit(const PackRun& run, const Surface& at) {
    double deformations[kPack];
    for (int p = run.begin; memory_.packs() && p < run.end; ++p) {
      kind().deformations(p, at, deformations);
      memory_.commit(p, laws_[run.direction], deformations, packs_[p].area);
    }
  }

  /// Enclose a change of the mesh, with resize() before endChange(). Surviving elements keep their
  /// memory.
  void beginChange() {
    before_places_ = places_;
    before_ = memory_;
  }
  void endChange(const Followed<Element>& change) {
    for (int k = 0; memory_.packs() && k < elements(); ++k) {
      if (!change.isNew(k)) memory_.set(places_.place(k), before_.get(before_places_.place(change.was[k])));
    }
  }

  /// Adds the energy of the new elements minus that of the removed ones [J]. @pre endChange()
  /// @param before, now surfaces before and after the change
  void addMade(const Followed<Element>& change, const Surface& before, const Surface& now,
               double& made) const {
    for (int k = 0; k < elements(); ++k) {
      if (!change.isNew(k)) continue;
      ElasticEnergy energy;
      kind().addEnergy(list_[k], k, loop(k), step(k).play, now, energy);
      made += energy.total();
    }
    for (int k = 0; k < before_places_.count(); ++k) {
      if (change.stays[k]) continue;
      const double play = before_.get(before_places_.place(k)).play;
      ElasticEnergy energy;
      kind().addEnergy(change.before[k], k, laws_[before_places_.direction(k)], play, before, energy);
      made -= energy.total();
    }
  }

  /// Adds the energy that the elements could give back.
  void addStored(const Surface& at, ElasticEnergy& sum) const {
    for (int k = 0; k < elements(); ++k) kind().addEnergy(list_[k], k, loop(k), step(k).play, at, sum);
  }

  void serialize(Archive& archive) { memory_.serialize(archive); }

 protected:
  /// @param list elements of this kind in the mesh
  /// @param laws laws of warp and weft, or the only law
  ElementEnergy(const ActiveMesh& mesh, const std::vector<Element>& list, std::vector<Loop> laws)
      : mesh_(mesh), list_(list), laws_(std::move(laws)), tables_(laws_.begin(), laws_.end()) {
    const int capacity = static_cast<int>(list.capacity());
    packs_.reserve(capacity / kPack + 2);
    if (!hasMemory()) return;
    for (ElementMemory* memory : {&memory_, &before_}) memory->reserve(capacity);
  }

  /// Starts empty packs for the elements of a rebuilt mesh.
  void startPacks(const PackedRange& places) {
    places_ = places;
    packs_.assign(places.size() / kPack, Pack{});
    if (hasMemory()) memory_.resize(places.size());
  }

  /// Law, and law within the step, of an element.
  const Loop& loop(int element) const { return laws_[places_.direction(element)]; }
  Loop::Step step(int element) const { return memory_.get(places_.place(element)); }
  void setPlay(int element, double play) { memory_.set(places_.place(element), loop(element).begin(play)); }

  const ActiveMesh& mesh_;
  const std::vector<Element>& list_;
  std::vector<Loop> laws_;
  std::vector<LawTable> tables_;
  PackedRange places_;
  std::vector<Pack> packs_;
  ElementMemory memory_;

 private:
  const Kind& kind() const { return static_cast<const Kind&>(*this); }

  PackedRange before_places_;  ///< places and memory before a change of the mesh
  ElementMemory before_;
};

}  // namespace haptic_cloth
