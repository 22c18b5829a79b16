/// Distances within which contacts are searched for a step.
#pragma once

#include <vector>

#include "contact/pair_finder.h"
#include "haptic_cloth/scene.h"
#include "sim/cloth.h"
#include "sim/probes.h"

namespace haptic_cloth {

class ClothObjective;

/// Largest displacement expected of each node and of any point of each probe. If one moved farther, a contact
/// may have been missed, and the step must be solved again with a larger reach.
class ContactReach {
 public:
  /// Zero for all: contacts of cloth that does not move. The arguments must outlive this object.
  ContactReach(const Scene& scene, const Cloth& cloth, const Probes& probes);

  /// Estimates the reach at the start of a step.
  void estimate();

  /// Checks that nothing moved farther in a solve than contacts were searched; otherwise widens the
  /// reach to twice the displacements.
  bool covers(const ClothObjective& solved);

  /// Checks that all nodes moved as pairs() expects. From now on it expects the motion of this solve, and
  /// twice the deviation of those that did not.
  bool coversPairs(const ClothObjective& solved);

  const std::vector<double>& nodes() const { return nodes_; }  ///< [m]
  PairFinder::Reach pairs() const { return {motion_, deviation_}; }
  const Field& motion() const { return motion_; }                  ///< expected displacement of each node [m]
  const std::vector<double>& proxies() const { return proxies_; }  ///< [m]

 private:
  bool coversNodes(const ClothObjective& solved);
  bool coversProxies(const ClothObjective& solved);

  const Scene& scene_;
  const Cloth& cloth_;
  const Probes& probes_;
  std::vector<double> nodes_, proxies_;
  Field motion_;                   ///< see PairFinder::Reach
  std::vector<double> deviation_;  ///< see PairFinder::Reach
};

}  // namespace haptic_cloth
