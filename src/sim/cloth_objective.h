/// Incremental potential of one step, Φ(X): motion and gravity, internal energy, contact and probe
/// coupling.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "parallel/parallel_for.h"
#include "sim/awake_set.h"
#include "sim/held_node.h"
#include "sim/motion.h"
#include "sim/multilevel_preconditioner.h"
#include "sim/probe_step.h"
#include "sim/time_integrator.h"
#include "sim/turn_spring.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// Acceleration in which residuals are measured: |gravity|, or that of the earth if a scene has none
/// [m/s²].
double referenceAcceleration(const Vec3& gravity);

/// Incremental potential of one step over the free nodes X, the proxies y and their turns ω:
///
///     Φ(X, y, ω) = Σ ½ m i |x - x̄|² - m g · (x - x⁰)                   motion, air, gravity
///             + Σ A ψ_s(ε) + Σ A ψ_b(κ) + Σ A (ψ_h(γ) + B_t κ_xy²)     internal energy
///             + contact and friction
///             + Σ ½ k |y - device|² + ½ (b/h) |y - y⁰ - h v_device|²   probes
///             + Σ r² (k e(θ) + ½ (b/h) |ω - ω_device|²)                turns of probes
///
/// θ is the angle between a proxy and its device, r² is turnRadiusSquared(), e that of TurnSpring.
/// x̄ is where inertia alone carries a node and i its inertia [1/s²], both by TimeIntegrator. The
/// gradient of Φ is the negative of Newton's residual [N].
class ClothObjective : public Objective {
 public:
  ClothObjective(const Scene& scene, const ActiveMesh& mesh, const TimeIntegrator& integrator,
                 InternalEnergy& internal, ContactSet& contacts, Team& team);

  /// Upper bound of size().
  int capacity() const { return 3 * mesh_.grid.particles() + 6 * static_cast<int>(probes_.size()); }

  /// Changes take effect with the next begin().
  void setCoupling(int probe, double stiffness, double damping) {
    couplings_[probe].stiffness = stiffness;
    couplings_[probe].damping = damping;
  }

  /// Starts a step from positions and velocities of the nodes, hanging ones included. All nodes are
  /// awake.
  /// @param probes one for each probe of the scene
  /// @param held free nodes that a present probe has grasped
  void begin(const Field& positions, const Field& velocities, const std::vector<ProbeStep>& probes,
             const std::vector<HeldNode>& held = {});

  /// Nodes that take part in the solve; begin() wakes all. Evaluations leave out sleeping nodes and
  /// the elements between them.
  AwakeSet& awake() { return awake_; }
  const AwakeSet& awake() const { return awake_; }

  /// Includes the forces on sleeping nodes in residual(). @pre the last evaluation covered all
  /// nodes
  void measureSleepers() { awake_.measureSleepers(gradient_, residual_weight_); }

  /// Negative forces on the nodes at the last evaluated point, as if the nodes had no velocity [N].
  void forcesAtRest(Field& forces) const;

  /// Gradient of all nodes at the last evaluated point [N].
  const Field& gradient() const { return gradient_; }

  int size() const override { return 3 * mesh_.free + probe_unknowns_; }
  const BlockOrder& order() const override { return unknown_order_; }
  double evaluate(const Vector& x, Vector& gradient) override;
  Along along(const Vector& d, double slope) override;
  bool keepClear(Vector& d, double step) override;

  /// Quadratic form d · H⁺ d [J]: part of the fabric, and of everything else.
  struct QuadraticForm {
    double fabric, others;
    double sum() const { return fabric + others; }
  };

  /// Quadratic form d · H⁺ d at the last evaluated point, with friction on probes as over the whole of d.
  /// @param deforms false: leaves out the fabric, since all nodes move alike
  QuadraticForm quadraticForm(const Vector& d, bool deforms = true);

  /// Tells whether a direction over all free nodes moves every node.
  bool allFree() const { return mesh_.pinned == 0 && held_.empty() && awake_.all(); }

  /// Sum of the forces on the awake nodes at the last evaluated point: Newton's residual as a whole [N].
  Vec3 netForce() const;

  /// Motion of free cloth as a whole that a net force asks for, by the quadratic model there [m].
  /// @pre allFree()
  Vec3 freeMotion(const Vec3& net_force) const;

  /// Largest admissible factor of d up to `most` at the last evaluated point.
  double maxStep(const Vector& d, double most);
  void fitPreconditioner(bool thoroughly) override;

  /// Must follow a change of the mesh.
  void resize() {
    if (multilevel_) multilevel_->resize();
  }
  void precondition(const Vector& gradient, Vector& z) override;
  double residual(const Vector& gradient) const override;

  /// Places the pinned nodes [m]. Call evaluate() after it.
  void setPinned(const Field& nodes);

  /// Share of the way of the pinned nodes to these positions [m] on which nothing is crossed while all else
  /// stands still. @pre evaluate() at the current positions
  double pinnedShare(const Field& to);

  /// Moves the pinned nodes by a share of their way to these positions [m]. Call evaluate() after it.
  void movePinned(const Field& to, double share);

  /// Share of the straight way from the last evaluated point to other positions of all nodes and to the
  /// proxies of x on which no listed pair and no probe's sample is crossed.
  double shareOfWay(const Field& to, const Vector& x);

  /// Packs node values, and the proxies given to begin(), as unknowns.
  void pack(const Field& nodes, Vector& x) const;

  /// Packs the free nodes' vectors as unknowns: all x, all y, all z.
  void packFree(const Field& nodes, Vector& x) const;

  /// Node values and proxies from unknowns; hanging nodes follow their masters.
  void unpack(const Vector& values, Field& nodes, Proxies& proxies) const;

  /// Places held nodes by their proxy, as it had turned at the last evaluation.
  void placeHeld(const Proxies& proxies, Field& nodes) const;
  /// Moves held nodes with their proxy along a direction.
  void moveHeld(const Proxies& directions, Field& motion) const;
  const std::vector<HeldNode>& held() const { return held_; }

  /// Gradient of the energy of motion, air and gravity at a node at x [N]. Its derivative is
  /// inertia(node) times the node's mass; see TimeIntegrator [1/s²].
  Vec3 motionGradient(int node, const Vec3& x) const {
    Vec3 gradient = -mesh_.mass[node] * gravity_;
    if (node < mesh_.free) gradient += moving_mass_[node] * inertia() * (x - inertial_[node]);
    return gradient;
  }
  double inertia() const { return integrator_.inertia(); }
  double inertia(int node) const { return integrator_.inertia(node); }

  /// Gradient of the coupling's energy by a proxy [N], and its stiffness [N/m].
  Vec3 couplingGradient(int probe, const Vec3& proxy) const;
  double couplingStiffness(int probe) const {
    return couplings_[probe].stiffness + couplings_[probe].damping / timeStep();
  }
  /// Stiffness of the coupling against a turn of the proxy [N·m].
  double turnStiffness(int probe) const;

  /// Saves or loads results of the last step that are queried later; begin() does not read them.
  void serialize(Archive& archive);

  Preconditioner preconditioner() const { return preconditioner_; }

  double timeStep() const { return integrator_.stepLength(); }  ///< length of the step [s]

  /// Unit of residuals: |gravity|, or 9.80665 without gravity [m/s²].
  double accelerationUnit() const { return acceleration_unit_; }

  /// residual() of a state with this motionCost() [J]; 0 if nothing is free to move.
  double residualOf(double cost) const {
    return residual_unit_ > 0.0 ? std::sqrt(2.0 * cost / residual_unit_) / timeStep() : 0.0;
  }

  /// Values at the last evaluated point:
  const Field& nodes() const { return nodes_; }
  const Vec3& proxy(int probe) const { return proxies_[probe].position; }
  /// Turn of a proxy in the step, a rotation vector [rad], and its orientation. Where its turn is not solved
  /// for, it is zero.
  const Vec3& turn(int probe) const { return proxies_[probe].turn; }
  Quat orientation(int probe) const;
  const std::vector<ProbeStep>& probeSteps() const { return probes_; }  ///< as given to begin()

  /// First index of a probe's proxy in x.
  int proxyAt(const ProbeStep& probe) const { return 3 * mesh_.free + probe.unknown; }

  /// Gradient for a proxy at the last evaluated point: what is left over of coupling, contact and held nodes
  /// [N].
  Vec3 proxyGradient(int probe) const;

  /// Force of the cloth on a probe [N], and its torque about the proxy [N·m].
  Vec3 force(int probe) const { return hold_forces_[probe] - contacts_.proxyGradient(probe); }
  Vec3 torque(int probe) const { return hold_torques_[probe] + contacts_.proxyTorque(probe, nodes_); }
  /// Those that balance the coupling: the same, but for what a solve has left undone, and for a second order
  /// of the turn in the step.
  Vec3 couplingForce(int probe) const { return couplingGradient(probe, proxy(probe)); }
  Vec3 couplingTorque(int probe) const;

  /// Energies at the last evaluated point [J]; for a fabric with memory its part of Φ, which is not
  /// what it stores.
  InternalEnergy::Energy fabricEnergy() const;
  double contactEnergy() const;
  double layerEnergy() const;  ///< part of contactEnergy(): between layers of the cloth
  double frictionPotential() const;
  double couplingEnergy() const;  ///< springs between devices and proxies, of turns, too
  double couplingEnergy(int probe) const;

  /// All of Φ but motion and gravity: these energies, and the potential of friction and coupling
  /// dampers [J].
  double storedAndLost() const;
  double motionCost() const;  ///< E^n = Σ h²/(2m) |residual|² over the free nodes [J]
  Vec3 pinForce() const;      ///< force of the pins on the cloth [N]
  /// Work of that force as the pins move from x⁰ to where they are [J].
  double pinWork() const;
  /// Work of Newton's residual on the free nodes from x⁰ to where they are [J].
  double workUndone() const;

 private:
  struct Coupling {
    double stiffness, damping;  ///< [N/m], [N·s/m]
    double square;              ///< turnRadiusSquared() [m²]
    double most_turn;           ///< in one iteration [rad]
  };

  template <class Visit>
  void forPresent(const Visit& visit) const;
  Vec3 slip(int probe, const Vec3& proxy) const;
  Vec3 turnSlip(int probe) const;
  TurnSpring turnSpring(int probe) const {
    return TurnSpring(orientation(probe), probes_[probe].device_orientation);
  }
  double couplingLoss(int probe) const;
  Vec3 turnGradient(int probe) const;
  double turnLimit(double most) const;
  double lossPotential() const;
  bool limitsSteps() const { return probe_unknowns_ > 0 || contacts_.meetsItself(); }
  void placeProbes();
  void fitMultilevel(bool thoroughly);
  double evaluateProbes(Vector& gradient);
  Sums evaluateElements(int begin, int end);
  double gatherNodes(int begin, int end);
  void setMotion(const Vector& d);
  QuadraticForm formAlongMotion(bool whole_motion, bool deforms);
  Motion motion() const;

  const ActiveMesh& mesh_;
  const TimeIntegrator& integrator_;
  InternalEnergy& internal_;
  ContactSet& contacts_;
  Team& team_;
  Vec3 gravity_;
  Preconditioner preconditioner_;
  std::vector<Coupling> couplings_;  ///< one for each probe of the scene
  double acceleration_unit_ = 1.0;   ///< see accelerationUnit() [m/s²]
  /// Mass of the free nodes times its square, the unit of squared residuals [kg m²/s⁴].
  double residual_unit_ = 1.0;

  std::vector<ProbeStep> probes_;
  std::vector<HeldNode> held_;
  int probe_unknowns_ = 0;  ///< of the present probes
  AwakeSet awake_;
  Field start_, inertial_;  ///< x⁰ and inertial positions of the nodes [m]
  /// Mass of all nodes; for free nodes mass times inertia(node)/inertia(), zero for others [kg].
  /// Both padded.
  std::vector<double> mass_, moving_mass_;
  Field nodes_, motion_, gradient_, diagonal_;
  Field detour_;       ///< what keepClear() changes in a direction [m]
  BlockField blocks_;  ///< blocks for the Jacobi preconditioner
  Proxies proxies_, proxy_motions_;
  std::vector<Vec3> hold_forces_, hold_torques_;  ///< of the held nodes on the probes [N], [N·m]
  Sums energies_ = Sums::Zero();
  Vector inverse_diagonal_, residual_weight_;
  BlockOrder unknown_order_;  ///< along the cloth: the unknowns are all x, all y, all z, and the proxies
  std::optional<MultilevelPreconditioner> multilevel_;
  std::vector<ProxyUnknown> proxy_unknowns_;
};

}  // namespace haptic_cloth
