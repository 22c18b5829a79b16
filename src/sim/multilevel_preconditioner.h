/// Approximate inverse of the Hessian of the condensed cost, for a fraction of the time of an
/// evaluation.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "mesh/block.h"
#include "mesh/hat_levels.h"
#include "parallel/parallel_for.h"
#include "sim/held_node.h"
#include "sim/layer_binding.h"
#include "sim/time_integrator.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// Unknowns of one proxy.
struct ProxyUnknown {
  int probe;
  int at;                 ///< index of its first unknown
  bool turns;             ///< its turn follows its position
  double stiffness;       ///< of its coupling [N/m]
  double turn_stiffness;  ///< of its coupling [N·m]
  Vec3 position;          ///< [m]
};

/// Preconditioner with two additive parts.
///
/// Nodes: the 3 × 3 diagonal blocks of the Hessian, inverted, with each proxy coupled to the nodes
/// that it touches. A contact sample counts as springs between the solid and each of its nodes;
/// eliminating the nodes inverts such a star of springs exactly.
///
/// Hat functions of each coarser level: their diagonal blocks, inverted (multilevel diagonal
/// scaling [Zhang, Multilevel Schwarz methods, Numer. Math. 63 (1992)]). They move wide parts of
/// the cloth at once, which no block of a node does. In the block of a hat the stiffness of
/// elements is the mean over the hat, because that of a membrane does not depend on the width of a
/// hat; inertia and contact are sums.
class MultilevelPreconditioner {
 public:
  /// @param probes number of probes in the scene
  MultilevelPreconditioner(const ActiveMesh& mesh, int probes, Team& team);

  /// Must follow a change of the mesh. Allocates nothing.
  void resize();

  /// Builds the blocks from the last evaluation.
  /// @param integrator gives the inertia of the nodes
  /// @param nodes positions of that evaluation [m]
  /// @param awake one flag for each node; only free nodes that are awake and not held are solved
  /// for
  /// @param binds_layers whether layers are bound (LayerBinding)
  void fit(const InternalEnergy& internal, const ContactSet& contacts, const TimeIntegrator& integrator,
           const std::vector<char>& awake, const Field& nodes, const std::vector<HeldNode>& held,
           const std::vector<ProxyUnknown>& proxies, bool binds_layers);

  /// Applies it to a gradient, with unknowns as in ClothObjective: all x of the free nodes, all y,
  /// all z, then the proxies, of each its position and perhaps its turn.
  void apply(const Vector& gradient, Vector& z);

 private:
  // Single precision is enough for an approximation; x, y, z and a zero are loaded by one
  // instruction.
  using HatValue = Eigen::Vector4f;
  using HatBlock = Eigen::Matrix<float, 4, 3>;

  /// Contact between a node and a proxy.
  struct Spring {
    int node;
    Block stiffness;  ///< [N/m]
    Vec3 arm;         ///< of the node, from the proxy; zero if that does not turn [m]
  };
  using BodyMatrix = Eigen::Matrix<double, 6, 6>;
  /// Proxy with the nodes that it touches. A shift comes before a turn.
  struct Body {
    int probe, at, unknowns;
    int springs, springs_end;
    Eigen::Matrix<double, 6, 1> coupling;  ///< its stiffness against each unknown
    BodyMatrix inverse;                    ///< holds the stiffness before bind()
  };

  void addElements(const InternalEnergy& internal);
  void addLayers(const ContactSet& contacts);
  void addContacts(const ContactSet& contacts, const Field& nodes, const std::vector<ProxyUnknown>& proxies);
  static void addSpring(const Block& stiffness, const Vec3& arm, BodyMatrix& sum);
  void bind(Body& body) const;
  Block ofNode(int n) const { return between_[n] + points_[n] + layers_[n]; }
  void invertNodes(const std::vector<char>& awake, const std::vector<HeldNode>& held);
  void invertHats();
  void invertHat(int k, bool square);
  void applyHats();
  void applyBody(const Body& body, const Vector& gradient, Vector& z) const;

  const ActiveMesh& mesh_;
  Team& team_;
  HatLevels hats_;
  /// Number of parts of the elements, used from kWorthParts nodes on.
  static constexpr int kParts = 4, kWorthParts = 1500;
  /// Blocks at the nodes from each part of the elements [N/m].
  std::array<BlockField, kParts> elements_;
  /// Blocks at all points [N/m]: of elements, and of inertia and contact.
  Blocks between_, points_;
  BlockField node_inverse_;            ///< free nodes; zero if they do not move [m/N]
  std::vector<HatBlock> hat_inverse_;  ///< hats; zero if they do not move [m/N]
  LayerBinding binding_;
  Blocks layers_;  ///< springs of layers at the nodes [N/m]
  Blocks touch_;   ///< blocks of one proxy's contacts at the nodes [N/m]
  std::vector<Spring> springs_;
  std::vector<Body> bodies_;
  std::vector<HatValue> values_, corrections_;  ///< at the points; of the hats
};

}  // namespace haptic_cloth
