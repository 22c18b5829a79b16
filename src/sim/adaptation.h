/// Adaptive mesh refinement and coarsening: where the cloth turns or its strain varies, cells split; where
/// both are smooth, they merge.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "energy/internal_energy.h"
#include "haptic_cloth/options.h"
#include "mesh/active_mesh.h"
#include "mesh/transfer.h"

namespace haptic_cloth {

/// A ball in which cells stay finest: the probe's surroundings.
struct FineRegion {
  Vec3 centre;
  double radius;  ///< [m]
};
using FineRegions = std::vector<FineRegion>;

/// The bending cost of a triple, ½ B κ² A, is compared in a form that suits any fabric, size and resolution:
/// as the turning angle κ l over the cell it would be judged on. The stretch cost enters as the difference of
/// strain over a cell, for that is what a larger cell cannot follow; slack threads, below zero, count as
/// unstrained.
class Adaptation {
 public:
  Adaptation(const AdaptOptions& options, const Grid& grid);

  /// For looks from now on. @pre the same levels
  void setOptions(const AdaptOptions& options) { options_ = options; }

  /// The age of the leaves. @param steps made so far
  void serialize(Archive& archive, long steps) {
    archive.within("born", born_, -options_.minimum_age, steps);
  }

  /// What the last apply() changed: parents merged, then cells split, in order.
  const std::vector<Cell>& merged() const { return merged_; }
  const std::vector<Cell>& split() const { return split_; }

  /// Level all leaves start at.
  static int startLevel(const AdaptOptions& options);

  /// Whether plan() looks at the mesh in this step, as it does every `interval` steps.
  bool looks(long step) const { return (refines() || coarsens()) && step % options_.interval == 0; }

  /// Turn [rad] by the load that a cell hides, of a leaf (parts 1) or of the parent of four leaves (parts 2).
  using HiddenTurn = std::function<double(const Cell& cell, int parts)>;

  /// Decides what splits and what merges, all from the mesh as it is. @return whether apply() has something
  /// to do  @param nodes positions of the nodes [m]
  bool plan(long step, const Field& nodes, const InternalEnergy& internal, const FineRegions& fine,
            const LeafMesh& leaves, const ActiveMesh& mesh, const ParticleState& state,
            const HiddenTurn& hidden);

  /// Does what was planned: rebuilds `mesh` and hands the state over.
  void apply(long step, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);

 private:
  void measureCurvature(const Field& nodes, const InternalEnergy& internal, const ActiveMesh& mesh);
  void measureStrain(const Field& nodes, const ActiveMesh& mesh);
  double turning(const Cell& cell, int parts, const ActiveMesh& mesh) const;
  double strainDifference(const Cell& cell, int parts, const ActiveMesh& mesh) const;
  void mergeCells(long step, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);
  void splitCells(long step, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);
  bool hasParent(const Cell& cell) const;
  bool refines() const;
  bool coarsens() const;
  bool mayMerge(const Cell& parent, long step, const FineRegions& fine, const LeafMesh& leaves,
                const ActiveMesh& mesh, const ParticleState& state, const HiddenTurn& hidden) const;
  bool touches(const FineRegions& fine, const Cell& cell, const std::vector<Vec3>& positions) const;
  double length(const Cell& cell) const;

  AdaptOptions options_;
  Grid grid_;
  std::vector<double> curvature_;              ///< largest |κ| at a node [1/m]
  std::array<std::vector<double>, 2> strain_;  ///< mean of a node's edges by direction, 0 where slack [-]
  std::vector<int> edges_;                     ///< of a node, scratch of measureStrain()
  std::vector<long> born_;                     ///< step a leaf came to be, at its lower left finest cell
  std::vector<Cell> leaves_, marked_, merged_, split_;
  MergeTransfer merge_transfer_;
};

}  // namespace haptic_cloth
