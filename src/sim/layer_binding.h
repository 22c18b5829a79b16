/// Layers of cloth that press on each other, in the preconditioner.
#pragma once

#include <vector>

#include "contact/self_contact.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "sim/block_factor.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// Binds nodes that stiff pairs of layers couple. A block of one node lets it move against the others alone,
/// so a stiff pair would hold its nodes fast, though they may move together. Here the blocks and springs of
/// all these nodes are inverted as one matrix. Soft pairs stay springs at their nodes.
class LayerBinding {
 public:
  explicit LayerBinding(const ActiveMesh& mesh);

  /// Binds the layers at the last evaluation.
  /// @param elements, others blocks of the nodes without layers are the sum of these [N/m]
  /// @param inverse inverted blocks of the free nodes; zero if they do not move [m/N]
  /// @param nodes positions [m]
  void fit(const SelfContact& layers, const Blocks& elements, const Blocks& others, const BlockField& inverse,
           const Field& nodes);

  void clear() { bound_.clear(); }  ///< binds nothing

  /// Replaces the blocks of bound nodes in a direction z, which contains inverse · gradient; both are vectors
  /// of all x of the free nodes, all y, all z, and more.
  void apply(const BlockField& inverse, const Vector& gradient, Vector& z);

 private:
  void addMasters(int node, double weight, const BlockField& inverse);

  const ActiveMesh& mesh_;
  BlockFactor factor_;
  std::vector<int> ghost_of_;           ///< index of each hanging node among the ghosts
  std::vector<int> row_of_;             ///< row of each node; -1: none
  std::vector<int> bound_;              ///< node of each row
  std::vector<BlockFactor::End> ends_;  ///< of the pair in work; by node, then by row
  std::vector<Vec3> values_;            ///< of each row
};

}  // namespace haptic_cloth
