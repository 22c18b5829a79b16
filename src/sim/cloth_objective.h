/// The incremental potential of one step, Φ(X): motion and gravity, internal energy, contact and probe
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
#include "parallel/runs.h"
#include "sim/held_node.h"
#include "sim/motion.h"
#include "sim/multilevel_preconditioner.h"
#include "sim/rest.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// A probe in one step.
struct ProbeStep {
  bool present = false;
  int unknown = 0;                      ///< its number among those that are present
  Vec3 device = Vec3::Zero();           ///< where the device is at the end of the step [m]
  Vec3 device_velocity = Vec3::Zero();  ///< [m/s]
  Vec3 proxy = Vec3::Zero();            ///< where the proxy is at the start of the step [m]

  void serialize(Archive& archive);
};

using Proxies = std::vector<Vec3>;  ///< a position or way for each probe of the scene [m]

/// Φ(X, y) = Σ m (1 + c h)/(2h²) |x - x⁰ - h v⁰/(1 + c h)|² - m g · (x - x⁰)            motion, air, gravity
///         + Σ A ψ_s(ε) + Σ A ψ_b(κ) + Σ A ψ_h(γ)                                       internal energy
///         + contact and friction + ½ k |y - device|² + ½ (b/h) |y - y⁰ - h v_device|²  probe, proxy at y
/// over the free nodes X and the proxy y. Its gradient is the negative of Newton's residual [N].
class ClothObjective : public Objective {
 public:
  ClothObjective(const Scene& scene, const ActiveMesh& mesh, InternalEnergy& internal, ContactSet& contacts,
                 Team& team);

  /// Largest size() can get.
  int capacity() const { return 3 * (mesh_.grid.particles() + static_cast<int>(probes_.size())); }

  /// From the next begin() on.
  void setAirDamping(double air_damping) { air_damping_ = air_damping; }
  void setCoupling(int probe, double stiffness, double damping) { couplings_[probe] = {stiffness, damping}; }

  /// Starts a step from node positions and velocities (ghosts included).
  /// @param probes of the scene  @param held free nodes that a present probe has grasped
  void begin(const Field& positions, const Field& velocities, const std::vector<ProbeStep>& probes,
             const std::vector<HeldNode>& held = {});

  /// Nodes may sleep: they and the elements around them are left out of the solve and stay where they are.
  /// begin() wakes all.
  void sleepAll();

  /// Forces on the nodes, with the opposite sign, if they stood still at the last evaluated point [N].
  void forcesAtRest(const Field& velocities, Field& forces) const;

  /// Wakes the free nodes that do not rest and some around them; what evaluates next is what concerns them.
  /// @return whether there were any  @pre the last evaluation looked at all
  bool wake(const Rest& rest);
  void wakeAll();

  /// Has everything evaluated until the next wake(), also what sleeps.
  void lookAtAll();

  /// Takes what is unbalanced at the sleepers into residual(). @pre the last evaluation looked at all
  void measureSleepers();
  bool allAwake() const { return all_awake_; }
  int awake() const;  ///< free nodes that are
  bool isAwake(int node) const { return awake_[node] != 0; }
  const Field& gradient() const { return gradient_; }  ///< of all nodes at the last evaluated point [N]

  int size() const override { return 3 * (mesh_.free + present_); }
  double evaluate(const Vector& x, Vector& gradient) override;
  Along along(const Vector& d) override;

  /// The fabric's part of d · H⁺ d [J] and that of all else.
  struct Curvature {
    double fabric, others;
    double sum() const { return fabric + others; }
  };

  /// d · H⁺ d at the last evaluated point, friction as it is over all of d. @param deforms false: not the
  /// fabric's part, since all nodes go alike
  Curvature curvatureOfWay(const Vector& d, bool deforms = true);

  /// Whether a way of all free nodes is one of all nodes.
  bool allFree() const { return mesh_.pinned == 0 && held_.empty() && all_awake_; }

  /// Largest admissible factor of d from the last evaluated point.
  double maxStep(const Vector& d);
  void fitPreconditioner() override;

  /// After a change of the mesh.
  void resize() {
    if (multilevel_) multilevel_->resize();
  }
  void precondition(const Vector& gradient, Vector& z) override;
  double residual(const Vector& gradient) const override;

  /// Unknowns from node values and proxies as begin() has them, for its mesh.
  void pack(const Field& nodes, Vector& x) const;

  /// The free nodes' vectors, as a solver's Vector has them: all x, all y, all z.
  void packFree(const Field& nodes, Vector& x) const;

  /// Node values and proxies from unknowns; ghosts follow their masters.
  void unpack(const Vector& values, Field& nodes, Proxies& proxies) const;

  /// Held nodes go where their proxy goes, at their `offsets` from it, or, for directions, as it does.
  void carryHeld(const Proxies& proxies, bool offsets, Field& nodes) const;
  const std::vector<HeldNode>& held() const { return held_; }

  /// Of the energy of motion, air and gravity by a node at x [N]; per mass it stiffens by inertia() [1/s²].
  Vec3 motionGradient(int node, const Vec3& x) const {
    Vec3 gradient = -mesh_.mass[node] * gravity_;
    if (node < mesh_.free) gradient += mesh_.mass[node] * inertia() * (x - inertial_[node]);
    return gradient;
  }
  double inertia() const { return (1.0 + air_damping_ * h_) / (h_ * h_); }

  /// Of the coupling's energy by a proxy [N], and its stiffness [N/m].
  Vec3 couplingGradient(int probe, const Vec3& proxy) const;
  double couplingStiffness(int probe) const {
    return couplings_[probe].stiffness + couplings_[probe].damping / h_;
  }

  /// The end of the last step as far as it is asked for afterwards; begin() does not look at it.
  void serialize(Archive& archive);

  double timeStep() const { return h_; }
  Preconditioner preconditioner() const { return preconditioner_; }

  /// What residuals are measured in [m/s²].
  double accelerationUnit() const { return std::sqrt(reference_acceleration_); }

  /// residual() of a state whose motionCost() is `cost` [J].
  double residualOf(double cost) const { return std::sqrt(2.0 * cost / reference_) / h_; }

  /// At the last evaluated point:
  const Field& nodes() const { return nodes_; }
  const Vec3& proxy(int probe) const { return proxies_[probe]; }
  const std::vector<ProbeStep>& probeSteps() const { return probes_; }  ///< as begin() was given them
  int proxyAt(const ProbeStep& probe) const { return 3 * (mesh_.free + probe.unknown); }  ///< in x
  Vec3 holdForce(int probe) const { return hold_forces_[probe]; }    ///< of the nodes it holds on it [N]
  Vec3 holdTorque(int probe) const { return hold_torques_[probe]; }  ///< the same about its proxy [N·m]
  double internalEnergy(
      Sums& parts) const;         ///< stretch, bend, shear, contact [J] as parts 0..3; returns their sum
  double couplingEnergy() const;  ///< springs between devices and proxies [J]
  double couplingEnergy(int probe) const;
  double lossPotential() const;  ///< friction and coupling damper: what the step dissipates there [J]
  double motionCost() const;     ///< E^n = Σ h²/(2m) |residual force|² [J]
  Vec3 pinForce() const;         ///< of the pins on the cloth [N]

 private:
  struct Coupling {
    double stiffness, damping;  ///< [N/m], [N·s/m]
  };

  template <class Visit>
  void forPresent(const Visit& visit) const;
  Vec3 slip(int probe) const;
  void placeProbes();
  void fitMultilevel();
  double evaluateProbes(Vector& gradient);
  void spread();
  void listAwake();
  Sums evaluateElements(int begin, int end);
  double gatherNodes(int begin, int end);
  void setMotion(const Vector& d);
  Curvature curvature(bool whole_way, bool deforms);
  Motion motion() const;

  const ActiveMesh& mesh_;
  InternalEnergy& internal_;
  ContactSet& contacts_;
  Team& team_;
  Vec3 gravity_;
  Preconditioner preconditioner_;
  double h_, air_damping_;
  std::vector<Coupling> couplings_;      ///< of the scene's probes
  double reference_acceleration_ = 1.0;  ///< |gravity|² [m²/s⁴]
  double reference_ = 1.0;  ///< mass times |gravity|², what residuals are measured in [kg m²/s⁴]

  std::vector<ProbeStep> probes_;
  std::vector<HeldNode> held_;
  int present_ = 0;                           ///< probes
  std::vector<char> awake_, seen_, reached_;  ///< a node each
  bool all_awake_ = true;
  double asleep_square_ = 0.0;              ///< the sleepers' part of the squared residual [-]
  Runs awake_elements_, awake_nodes_;       ///< what evaluate() and along() look at
  Field start_, inertial_;                  ///< x⁰ and x⁰ + h v⁰/(1 + c h) of the nodes [m]
  std::vector<double> mass_, moving_mass_;  ///< of all nodes; of the free ones, zero for others; padded [kg]
  Field nodes_, motion_, gradient_, diagonal_;
  BlockField blocks_;  ///< of the Jacobi preconditioner
  Proxies proxies_, proxy_motions_, hold_forces_, hold_torques_;
  Sums energies_ = Sums::Zero();
  Vector inverse_diagonal_, residual_weight_;
  std::optional<MultilevelPreconditioner> multilevel_;
  std::vector<ProxyUnknown> proxy_unknowns_;
};

}  // namespace haptic_cloth
