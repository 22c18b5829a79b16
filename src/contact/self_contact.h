/// Contact of the cloth with itself.
#pragma once

#include <algorithm>
#include <vector>

#include "contact/compression_law.h"
#include "contact/friction_memory.h"
#include "contact/pair_finder.h"
#include "contact/pair_packs.h"
#include "contact/sample_packs.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "mesh/field.h"
#include "mesh/grid.h"
#include "parallel/runs.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Pairs of parts of the cloth that may meet in a step (PairFinder), their pressure and friction. No
/// pair ever crosses: maxStep() limits each step of the solve. Most pairs only might meet. They are
/// measured again only when the nodes have travelled so far that they might press (PairBound).
class SelfContact {
 public:
  struct Options {
    CompressionLaw law;
    double friction;  ///< coefficient of friction between layers [-]
  };

  /// @param slip slip in a step below which friction is smoothed [m]
  SelfContact(const Grid& grid, const Options& options, double slip);

  void setSlip(double slip) { slip_ = slip; }  ///< see the constructor [m]

  /// Must follow a change of the mesh.
  void rebuild(const ActiveMesh& mesh);

  /// Finds the pairs of a step and freezes their friction. The parameters are those of
  /// PairFinder::find().
  void collect(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals,
               const PairFinder::Reach& reach, const std::vector<char>& dented);

  /// Remembers the friction of all pairs at the last evaluation for the next step.
  void rememberFriction(const ActiveMesh& mesh, const ConstArrays& normals);

  static constexpr int kFaces = 4;  ///< on which friction is remembered: two of points, two of lines

  /// Saves or loads what friction remembers; pairs are found in each step.
  void serialize(Archive& archive);

  void beginChange(const ActiveMesh& mesh, const Field& nodes) { finder_.beginChange(mesh, nodes); }
  bool hasRoom(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved) {
    return finder_.hasRoom(mesh, nodes, cell, moved, law_.leastRoom());
  }

  void forgetRough() { finder_.forgetRough(); }

  /// Tells whether no parts of the cloth that are not a pair can have met on the straight way to the end of
  /// the step. @param deviates see PairFinder::mayMeetUnlisted()
  bool unlistedStayApart(const ActiveMesh& mesh, const Field& start, const Field& end, bool deviates) {
    return !finder_.mayMeetUnlisted(mesh, start, end, deviates, packs_);
  }

  /// Tells whether no pair can have met on that way, which ends at the last evaluated point. A solve may lead
  /// a pair around something on another way.
  bool pairsStayApart(const Field& start, const Field& end) const;

  /// Number of pairs, and of those with friction: length of the range that evaluate() and quadraticForm()
  /// divide in multiples of kPack.
  int size() const { return kPack * static_cast<int>(packs_.size() + drags_.size()); }
  int capacity() const { return kPack * static_cast<int>(packs_.capacity() + drags_.capacity()); }

  /// Notes where the nodes are for the next evaluation.
  void noteMotion(const Field& nodes);

  /// Evaluates pairs begin..end. @return their energy  @pre noteMotion()
  ContactEnergy evaluate(int begin, int end, const Field& nodes);

  /// Quadratic form d · H⁺ d of pairs begin..end at the last evaluation.
  double quadraticForm(int begin, int end, const Field& d) const;

  /// Sums up the forces of all pairs at the last evaluation for addGradient().
  void sumForces(int nodes);

  /// Adds the energy gradient at nodes begin..end [N].  @pre sumForces()
  void addGradient(int begin, int end, Field& gradient) const;

  /// Calls visit(points, lane, stiffness) for the pressure of all pairs and for all friction, with their
  /// stiffness against Σ weights · x [N/m].  @param nearest distance below which pressure does not get
  /// stiffer [ranges]
  template <class Visit>
  void forSprings(double nearest, const Visit& visit) const {
    forPressing([&](const PairPack& pack, int l) {
      const double nearness = pack.distance[l] / (nearest * pack.range[l]);
      const double spring = pack.stiffness[l] * std::min(1.0, nearness * nearness);
      visit(pack, l, Block(spring * square(laneOf(pack.normal, l))));
    });
    forDrags([&](const DragPack& drag, int l) { visit(drag, l, springOf(drag, l)); });
  }

  /// Adds the stiffness of all pairs to their nodes in proportion to the weights [N/m].
  void addSprings(Blocks& blocks) const;

  /// Adds the diagonal of H⁺ at all nodes [N/m].
  void addDiagonal(Field& diagonal) const;

  /// Largest factor of d up to `most`, from `nodes`, the last evaluated point, at which no pair uses up
  /// more than 0.9 of its distance, nor comes nearer than `least_ranges` times its range.
  double maxStep(const Field& nodes, const Field& d, double most, double least_ranges);

  /// Slows pairs that a step of `step` along d, from `nodes`, would stop: adds to `change` what their points
  /// must move by, each by half, so that no pair uses up more than the share of its distance that maxStep()
  /// admits.  @pre maxStep() with this step or more  @return whether there are any
  bool keepClear(const Field& nodes, const Field& d, double step, Field& change) const;

  /// Adds the stacks that act on an awake node to `runs`, counted from `first`.
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const;

  /// Sets the flags of the nodes of all pairs to 1.
  void markListed(std::vector<char>& nodes) const;

  /// Calls visit(pack, lane) for all pairs.
  template <class Visit>
  void forPairs(const Visit& visit) const {
    for (const PairPack& pack : packs_) {
      for (int l = 0; l < kPack; ++l) {
        if (pack.range[l] > 0.0) visit(pack, l);
      }
    }
  }

  /// Calls visit(pack, lane) for all pairs with friction.
  template <class Visit>
  void forDrags(const Visit& visit) const {
    for (const DragPack& drag : drags_) {
      for (int l = 0; l < kPack; ++l) {
        if (drag.limit[l] > 0.0) visit(drag, l);
      }
    }
  }

  int touching() const;  ///< number of points and lines that press, by side
  /// Smallest distance of all pairs at `nodes`, the last evaluated point; infinite without pairs [m].
  double smallestDistance(const Field& nodes);

 private:
  /// Where a pair presses on its first part.
  struct Place {
    int face;  ///< of the cloth: 0 and 1 for points, 2 and 3 for lines
    FlatPoint at;
    double half;  ///< half the width of the cloth that it stands for [finest cells]
  };

  /// Calls visit(pack, lane) for all pairs that carried force at the last evaluation.
  template <class Visit>
  void forPressing(const Visit& visit) const {
    for (std::size_t p = 0; p < packs_.size(); ++p) {
      if (!bounds_[p].presses) continue;
      for (int l = 0; l < kPack; ++l) {
        if (packs_[p].pressing[l] != 0.0) visit(packs_[p], l);
      }
    }
  }

  /// Calls visit(p, lane) for all lanes of all stacks; p is the index of the first pack.
  template <class Visit>
  void forStacks(const Visit& visit) const {
    for (int p = 0; p < static_cast<int>(packs_.size()); p += bounds_[p].stack) {
      for (int l = 0; l < kPack; ++l) visit(p, l);
    }
  }

  Block springOf(const DragPack& drag, int lane) const;
  void listPaired(const Field& nodes);
  void listDrags(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals);
  void beginDrag(DragPack& drag, int lane, int pair, double limit, const ActiveMesh& mesh, const Field& nodes,
                 const ConstArrays& normals);
  Place placeOf(const DragPack& drag, int lane, const ActiveMesh& mesh, const ConstArrays& normals) const;

  Grid grid_;
  CompressionLaw law_;
  double friction_, slip_;
  FrictionMemory memory_;  ///< on each face, as on a solid
  PairFinder finder_;
  std::vector<PairPack> packs_;
  std::vector<PairBound> bounds_;  ///< one for each pack
  std::vector<DragPack> drags_;
  std::vector<char> is_paired_;       ///< one flag for each node
  std::vector<int> paired_;           ///< nodes of pairs
  std::vector<Vec3> last_positions_;  ///< of these nodes at the last noteMotion() [m]
  double travelled_ = 0.0;            ///< see PairContext
  Field gradient_;                    ///< of these nodes, see sumForces() [N]
};

}  // namespace haptic_cloth
