/// Adaptive mesh: cells split where the cloth turns or its strain varies, and merge where both are
/// smooth.
#pragma once

#include <array>
#include <climits>
#include <functional>
#include <vector>

#include "haptic_cloth/options.h"
#include "mesh/active_mesh.h"
#include "mesh/edge_means.h"
#include "mesh/transfer.h"

namespace haptic_cloth {

/// Two balls around a probe: cells are finest in the inner one, and keep the thresholds in the outer one.
struct ProbeRegion {
  Vec3 centre;
  double finest_radius;  ///< in which cells stay finest [m]
  double near_radius;    ///< in which the far factors of the thresholds do not count [m]
};
using ProbeRegions = std::vector<ProbeRegion>;

/// Mesh decisions from turning angles and strain. The stretch cost enters as the difference of strain
/// over a cell, which a larger cell cannot represent, and as the strain that its split would create.
/// Slack threads (strain below zero) count as unstrained in the first.
class Adaptation {
 public:
  Adaptation(const AdaptOptions& options, const Grid& grid);

  /// Changes the options for the next decisions. @pre the same levels
  void setOptions(const AdaptOptions& options) { options_ = options; }

  /// Saves or loads the age of the leaves, and time and thresholds of the last decision.
  /// @param tick simulated time so far
  void serialize(Archive& archive, long tick) {
    archive.within("born", born_, kLongAgo, tick);
    archive.within("decided", decided_, kNever, tick);
    archive("decided_below", decided_below_);
    archive("decided_below_strain", decided_below_strain_);
  }

  /// Changes made by the last apply(): merged parents and split cells, in order.
  const std::vector<Cell>& merged() const { return merged_; }
  const std::vector<Cell>& split() const { return split_; }

  /// Level of all leaves in the initial mesh.
  static int startLevel(const AdaptOptions& options);

  /// Starts a decision if one is due: a multiple of `interval` has come since the last one. A step that is
  /// longer than that decides once. If the thresholds of merges have grown since the last one, cells of any
  /// age may merge. @param tick simulated time, like that of plan() and apply() [time steps]
  bool startDecision(long tick);

  /// Tells whether a decision was started at that time. @param tick simulated time [time steps]
  bool decidesAt(long tick) const { return decided_ == tick; }

  /// Tells whether decisions can change the mesh.
  bool changesMesh() const { return refines() || coarsens(); }

  /// Turning angle of a leaf (parts 1) or of the parent of four leaves (parts 2) [rad]; see
  /// TurnEstimate::turn().
  using Turn = std::function<double(const Cell& cell, int parts, double enough)>;

  /// Tells whether the surface of a leaf that splits (parts 1) or of a parent whose leaves merge (parts 2)
  /// has room to move by a distance [m].
  using Room = std::function<bool(const Cell& cell, int parts, double moved)>;

  /// Tells whether a leaf (parts 1) or the parent of four leaves (parts 2) is near probes by what it carries.
  using Carries = std::function<bool(const Cell& cell, int parts)>;

  /// Input of a decision.
  struct View {
    long tick;           ///< simulated time [time steps]
    const Field& nodes;  ///< positions of the nodes [m]
    const ProbeRegions& probes;
    const LeafMesh& leaves;
    const ActiveMesh& mesh;
    const ParticleState& state;
    Turn turn;
    Carries carries;
    Room room;
  };

  /// Decides all splits and merges. @return whether apply() has anything to do
  bool plan(const View& view);

  /// Makes the planned changes: rebuilds `mesh` and hands the state over.
  void apply(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);

 private:
  /// Thresholds of splits or of merges.
  struct Thresholds {
    double turn, strain;  ///< [rad], [-]
  };

  static constexpr long kNever = -1;
  static constexpr long kLongAgo = LONG_MIN / 4;  ///< beyond any minimum_age before any tick

  void measureStrain(const Field& nodes, const ActiveMesh& mesh);
  double strainDifference(const Cell& cell, int parts, const ActiveMesh& mesh) const;
  double shortening(const Cell& cell, const std::vector<Vec3>& positions) const;
  void mergeCells(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);
  void splitCells(long tick, LeafMesh& leaves, ActiveMesh& mesh, ParticleState& state);
  bool hasParent(const Cell& cell) const;
  bool refines() const;
  bool coarsens() const;
  bool maySplit(const View& view, const Cell& cell) const;
  bool mayMerge(const View& view, const Cell& parent) const;
  template <class Visit>
  void forNeighbours(const Cell& cell, const Visit& visit) const;
  void findSplits(const LeafMesh& leaves);
  bool touchesSplit(const Cell& parent, const LeafMesh& leaves) const;
  bool touches(const ProbeRegions& probes, double ProbeRegion::*radius, const Cell& cell,
               const std::vector<Vec3>& positions) const;
  bool hasFarFactors() const;
  Thresholds thresholdsOf(const View& view, const Thresholds& near, const Cell& cell, int parts) const;

  AdaptOptions options_;
  Grid grid_;
  /// Mean strain of a node's edges by direction, 0 if slack [-].
  std::array<std::vector<double>, 2> strain_;
  EdgeMeans edge_means_;
  std::vector<long> born_;  ///< tick at which a leaf was created, at its lower left finest cell
  long decided_ = kNever;   ///< tick of the last decision
  double decided_below_, decided_below_strain_;  ///< its thresholds of merges far from probes [rad], [-]
  std::vector<Cell> leaves_, marked_, merged_, split_;
  /// Flag for each finest cell: the leaf with its lower left corner there has no room for the bilinear
  /// place of its centre. Set for all leaves that apply() splits.
  std::vector<char> crowded_;
  std::vector<char> splits_;  ///< flag for each finest cell: the leaf with that corner is in split_
  MergeTransfer merge_transfer_;
};

}  // namespace haptic_cloth
