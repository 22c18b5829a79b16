/// The parts of one simulation and how a step uses them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"
#include "mesh/transfer.h"
#include "sim/adaptation.h"
#include "sim/cloth_objective.h"
#include "sim/joint_objective.h"
#include "sim/load_estimate.h"
#include "solver/minimizer.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Cloth, obstacles and probe: state, scratch and the method. Simulation wraps it.
class ClothWorld {
 public:
  /// @pre scene is valid
  explicit ClothWorld(const Scene& scene);

  void setDevice(int probe, const DeviceState& device);
  void removeDevice(int probe);
  void setGrasp(int probe, bool closed);
  void moveObstacle(int obstacle, const Pose& pose) { contacts.moveObstacle(obstacle, pose); }
  StepReport step();

  /// All that the next step, or what is asked before it, reads from the steps before; the rest is scratch or
  /// the scene's. To load: into a world of that scene that has made no step, which must not be used if this
  /// throws.
  void serialize(Archive& archive);
  /// From the next step on. @pre valid, and what must not change is the same
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping);
  void setCoupling(int probe, double stiffness, double damping);

  /// How the mesh follows the shape from the next step on. @pre the same levels
  void setAdaptOptions(const AdaptOptions& options) {
    adaptation_.setOptions(options);
    forgetIdle();
  }

  Scene scene;
  Grid grid;
  LeafMesh leaves;
  ActiveMesh mesh;
  ParticleState state;
  InternalEnergy internal;
  ContactSet contacts;
  Team team;
  ClothObjective objective;
  CostReport cost;  ///< of the last solve
  std::vector<ProbeReport> probes;
  Vec3 support_force = Vec3::Zero();
  long steps = 0;

  double time() const { return steps * scene.solver.time_step; }
  double mass() const;
  double created() const { return created_; }  ///< energy that the last step's change of the mesh made [J]
  EnergyReport energy() const;
  double maxSpeed() const;
  const Field& nodes() const { return nodes_; }

  /// By which the next look at the mesh judges the load on its cells; holds until then.
  LoadEstimate::View loadView();

 private:
  void takeStep(StepReport& report);
  bool isIdle() const;
  bool devicesStay() const;
  StepReport idle();
  void noteIdle(const StepReport& report);
  void forgetIdle() {
    quiet_ = 0;
    idle_ = false;
  }
  void gatherNodes();
  void takeMesh();
  void serializeCloth(Archive& archive);
  void serializeProbes(Archive& archive);
  void serializeIdle(Archive& archive);
  void adapt(StepReport& report);
  bool planMesh();
  void measureWeight();
  void solve(StepReport& report);
  void takeHold();
  double wayAhead(int probe) const;
  void findContacts(const std::vector<double>& proxy_reach);
  MinimizerReport minimise();
  MinimizerReport minimiseJoint();
  bool wakeUnrested();
  void moveAsAWhole(MinimizerReport& report);
  void lookAtRest();
  double chooseStart();
  std::array<double, 2> stepsAlongWays();
  bool covered();
  bool proxiesCovered(std::vector<double>& proxy_reach) const;
  void accept(StepReport& report);
  void acceptProbe(int probe);
  void restore();
  double guardEnergy(double left);
  void account();
  double kineticEnergy() const;  ///< [J]
  EnergyReport measureMotion() const;

  Adaptation adaptation_;
  LoadEstimate load_;
  /// Gravity less acceleration of the nodes in the last step, across the surface, for load_ [m/s²].
  std::vector<double> weight_;
  Rest rest_;
  Field forces_;                         ///< on the nodes at rest, for rest_ [N]
  std::vector<char> let_out_nodes_;      ///< scratch of accept(): a node each
  int quiet_ = 0;                        ///< steps in a row in which all slept and no input changed
  bool idle_ = false;                    ///< enough of them
  std::vector<ProbeStep> idle_probes_;   ///< as they were then
  double idle_residual_ = 0.0;           ///< of the last step that was solved
  std::optional<ForceHistory> history_;  ///< of a fabric with hysteresis
  std::optional<JointObjective> joint_;  ///< where the scene asks for that cost
  Minimizer minimizer_;
  /// What the cloth knows of a probe from step to step.
  struct ProbeMemory {
    bool entered = false;  ///< it has been clear of the cloth once; before, it touches nothing
    bool closed = false;   ///< it grasps what it touches
    Quat before = Quat::Identity(), after = Quat::Identity();  ///< how it turns in the step in hand
    double coupling = 0.0;                                     ///< energy at the end of the last step [J]

    void serialize(Archive& archive);
  };
  struct HeldParticle {
    int particle, probe;
    Vec3 offset;  ///< from the proxy [m]
  };
  std::vector<ProbeStep> probe_steps_;
  std::vector<ProbeMemory> memories_;
  std::vector<HeldParticle> held_;
  std::vector<HeldNode> held_nodes_;          ///< the same by node, of the step in hand
  std::vector<std::vector<int>> touched_by_;  ///< particles that pressed on a closed probe in the last step
  std::vector<int> touched_;                  ///< scratch of acceptProbe()
  std::vector<double> proxy_reach_;           ///< [m]
  std::vector<ContactSet::Reach> touching_;
  FineRegions fine_;
  std::vector<LoadEstimate::Touch> touches_;  ///< of loadView()
  double initial_ = 0.0;                      ///< energy at the start [J]
  double supplied_ = 0.0;                     ///< that and what devices and obstacles have worked since [J]
  double created_ = 0.0;                      ///< by the mesh change of the step in hand [J]
  double let_out_ = 0.0;        ///< work of obstacles at the start of the next step, see ContactSet [J]
  double at_rest_ = 0.0;        ///< Φ of the step in hand with all at rest [J]
  double energy_before_ = 0.0;  ///< Φ's energies at the start of the step in hand, with its inputs [J]
  Field nodes_, velocities_;
  std::vector<double> reach_;  ///< how far a node is expected to move in the step in hand [m]
  Vector x_, start_, motion_, gradient_, joint_x_;
  std::array<Vector, 2> ways_;  ///< inertial motion, and what gravity adds to it
};

}  // namespace haptic_cloth
