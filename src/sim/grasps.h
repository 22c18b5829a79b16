/// Cloth that closed probes hold.
#pragma once

#include <vector>

#include "contact/contact_set.h"
#include "mesh/active_mesh.h"
#include "mesh/transfer.h"
#include "sim/held_node.h"
#include "sim/probes.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Which probe holds which particles. A closed probe that holds nothing grasps the particles that
/// pressed on it at the end of the last step. A particle has at most one holder. What is held moves and turns
/// with the probe.
class Grasps {
 public:
  Grasps(int probes, const Grid& grid);

  /// Lets go of everything that a probe holds or might grasp next.
  void release(int probe);

  /// Updates the grasps at the start of a step. Particles that left the mesh are not held in it.
  void update(const Probes& probes, const ActiveMesh& mesh, const ParticleState& state);

  const std::vector<HeldNode>& nodes() const { return nodes_; }  ///< held in the current step
  bool holds(int probe) const;  ///< tells whether it holds a node in the current step

  /// Records what presses on the closed probes at the end of a step.
  void noteTouched(const Probes& probes, const ContactSet& contacts, const ActiveMesh& mesh);

  void serialize(Archive& archive);

 private:
  struct HeldParticle {
    int particle, probe;
    Vec3 arm;  ///< from the proxy, in axes that turn with the probe [m]
  };

  int particles_;  ///< number of particles of the finest grid
  std::vector<HeldParticle> held_;
  std::vector<HeldNode> nodes_;
  /// Particles that pressed on each probe, if closed, at the end of the last step.
  std::vector<std::vector<int>> touched_by_;
  std::vector<int> touched_;  ///< scratch of noteTouched()
};

}  // namespace haptic_cloth
