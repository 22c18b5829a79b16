/// An approximate inverse of the condensed cost's Hessian, for the cost of a fraction of an evaluation.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "mesh/block.h"
#include "mesh/hat_levels.h"
#include "parallel/parallel_for.h"
#include "sim/held_node.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// A proxy among the unknowns.
struct ProxyUnknown {
  int probe;
  int at;            ///< its first unknown
  double stiffness;  ///< of its coupling [N/m]
};

/// The sum of two parts.
/// Nodes: their own 3 x 3 blocks of the Hessian, inverted, with the proxies bound to the nodes they touch. A
/// contact sample counts as springs between the solid and each of the sample's nodes, and elimination of the
/// nodes inverts such a star of springs exactly.
/// Hats of each coarser level: their own blocks, inverted, which is multilevel diagonal scaling [Zhang,
/// Multilevel Schwarz methods, Numer. Math. 63 (1992)]. It moves wide parts of the cloth at once, as no
/// node's block does. The elements' part of a hat's block is the mean over the hat (that of a membrane does
/// not depend on a hat's width), inertia and contact are sums.
class MultilevelPreconditioner {
 public:
  /// @param probes the scene has
  MultilevelPreconditioner(const ActiveMesh& mesh, int probes, Team& team);

  /// After a change of the mesh. Allocates nothing.
  void resize();

  /// From the last evaluation. @param inertia stiffness per mass [1/s²]  @param awake nodes, of which those
  /// that are free and not held are solved for
  void fit(const InternalEnergy& internal, const ContactSet& contacts, double inertia,
           const std::vector<char>& awake, const std::vector<HeldNode>& held,
           const std::vector<ProxyUnknown>& proxies);

  /// Unknowns as ClothObjective has them: all x of the free nodes, all y, all z, then the proxies.
  void apply(const Vector& gradient, Vector& z);

 private:
  // In single precision, as what is approximate needs no more; x, y, z and a zero are one instruction's load.
  using HatValue = Eigen::Vector4f;
  using HatBlock = Eigen::Matrix<float, 4, 3>;

  /// Contact between a node and a proxy.
  struct Spring {
    int node;
    Block stiffness;  ///< [N/m]
  };
  struct Proxy {
    int probe, at;
    int springs, springs_end;
    Block inverse;  ///< [m/N], of the stiffness until it is bound
  };

  void addElements(const InternalEnergy& internal);
  void addContacts(const ContactSet& contacts, const std::vector<ProxyUnknown>& proxies);
  void bind(Proxy& proxy) const;
  void invertNodes(const std::vector<char>& awake, const std::vector<HeldNode>& held);
  void invertHats();
  void invertHat(int k);
  void applyHats();
  Vec3 entry(const Vector& gradient, int node) const {
    return {gradient[node], gradient[mesh_.free + node], gradient[2 * mesh_.free + node]};
  }
  void applyProxy(const Proxy& proxy, const Vector& gradient, Vector& z) const;

  const ActiveMesh& mesh_;
  Team& team_;
  HatLevels hats_;
  static constexpr int kParts = 4, kWorthParts = 1500;  ///< parts of the elements, if there are many nodes
  std::array<BlockField, kParts> elements_;  ///< blocks of a part of the elements each, at the nodes [N/m]
  Blocks between_, points_;                  ///< of elements; of inertia and contact; at all points [N/m]
  BlockField node_inverse_;                  ///< of the free; zero for those that do not move [m/N]
  std::vector<HatBlock> hat_inverse_;        ///< the same
  Blocks touch_;                             ///< of one proxy's contacts, at the nodes [N/m]
  std::vector<Spring> springs_;
  std::vector<Proxy> proxies_;
  std::vector<HatValue> values_, corrections_;  ///< at the points; of the hats
};

}  // namespace haptic_cloth
