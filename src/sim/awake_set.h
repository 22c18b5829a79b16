/// Nodes that take part in a solve.
#pragma once

#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "mesh/active_mesh.h"
#include "parallel/block_order.h"
#include "parallel/runs.h"
#include "sim/sleep_tracker.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// Awake nodes, and the elements and nodes that an evaluation must cover because of them. Sleeping
/// nodes keep their position. Elements are numbered as in ClothObjective: those of the fabric, then
/// the contact samples.
class AwakeSet {
 public:
  AwakeSet(const ActiveMesh& mesh, const InternalEnergy& internal, const ContactSet& contacts);

  /// Starts a step. All nodes are awake.
  void begin();

  /// Puts all nodes to sleep. Evaluations still cover everything until the next wake().
  void sleepAll();

  /// Wakes the free nodes that may not sleep, with some around them; later evaluations cover these.
  /// @return whether there were any
  bool wake(const SleepTracker& sleep);
  void wakeAll();

  /// Makes evaluations cover everything, sleeping nodes included, until the next wake().
  void coverAll();

  /// Measures the share of the sleeping nodes in the squared residual.
  /// @param gradient of all nodes [N]
  /// @param weight of the free nodes in the squared residual
  void measureSleepers(const Field& gradient, const Vector& weight);
  double sleepersSquare() const { return sleepers_square_; }

  bool all() const { return all_; }
  int count() const;  ///< number of free nodes that are awake
  bool contains(int node) const { return awake_[node] != 0; }
  const std::vector<char>& flags() const { return awake_; }  ///< one for each node

  /// Sets the entries of sleeping nodes to zero, in a vector of the free nodes' unknowns.
  void clearSleepers(Vector& x) const;

  const Runs& elements() const { return elements_; }                 ///< covered by evaluations
  const BlockOrder& elementOrder() const { return element_order_; }  ///< along the cloth, if all are covered
  const Runs& nodes() const { return nodes_; }  ///< covered by evaluations, in whole packs

 private:
  void spread();
  void listCovered();

  const ActiveMesh& mesh_;
  const InternalEnergy& internal_;
  const ContactSet& contacts_;
  std::vector<char> awake_;           ///< one flag for each node
  std::vector<char> seen_, reached_;  ///< scratch of wake(): one flag for each node
  bool all_ = true;
  double sleepers_square_ = 0.0;
  Runs elements_, nodes_;
  BlockOrder element_order_;
};

}  // namespace haptic_cloth
