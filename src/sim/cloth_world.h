/// Parts of one simulation, and how a step uses them.
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

/// Cloth, obstacles and probes: state, scratch memory and method. Simulation wraps this class.
class ClothWorld {
 public:
  /// @pre scene is valid
  explicit ClothWorld(const Scene& scene);

  void setDevice(int probe, const DeviceState& device);
  void removeDevice(int probe);
  void setGrasp(int probe, bool closed);
  void moveObstacle(int obstacle, const Pose& pose) { contacts.moveObstacle(obstacle, pose); }
  StepReport step();

  /// Saves or loads everything that later steps and queries read; the rest is scratch or part of
  /// the scene. @pre loading: a world of the same scene that has made no step. If loading throws,
  /// the world must not be used.
  void serialize(Archive& archive);
  /// Changes options from the next step on. @pre valid, and options that must not change are the
  /// same
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping);
  void setCoupling(int probe, double stiffness, double damping);

  /// Changes the mesh options from the next step on. @pre the same levels
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
  Team team;
  ContactSet contacts;
  ClothObjective objective;
  CostReport cost;  ///< costs of the last solve
  std::vector<ProbeReport> probes;
  Vec3 support_force = Vec3::Zero();
  long steps = 0;

  double time() const { return steps * scene.solver.time_step; }
  double mass() const;
  /// Energy that the mesh change and the contact samples of the last step created [J].
  double created() const { return created_ + sampled_; }
  EnergyReport energy() const;
  double maxSpeed() const;
  const Field& nodes() const { return nodes_; }

  /// Inputs of the next mesh decision's load estimate; valid until the next call.
  LoadEstimate::View loadView();

 private:
  void takeStep(StepReport& report);
  bool isIdle() const;
  bool devicesStay() const;
  bool solidsMove() const;
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
  /// Gravity minus acceleration of the nodes in the last step, along the surface normal, for load_
  /// [m/s²].
  std::vector<double> weight_;
  SleepTracker sleep_;
  Field forces_;                         ///< negative forces on the nodes at rest, for sleep_ [N]
  std::vector<char> let_out_nodes_;      ///< scratch of accept(): one flag for each node
  int quiet_ = 0;                        ///< steps in a row in which all slept and no input changed
  bool idle_ = false;                    ///< quiet_ is large enough: steps are skipped
  std::vector<ProbeStep> idle_probes_;   ///< probes in the last solved step
  double idle_residual_ = 0.0;           ///< residual of the last solved step
  std::optional<ForceHistory> history_;  ///< set for a fabric with hysteresis
  std::optional<JointObjective> joint_;  ///< set for the joint cost
  Minimizer minimizer_;
  /// State of a probe that is kept between steps.
  struct ProbeMemory {
    /// Has been clear of the cloth since it appeared; touches nothing before.
    bool entered = false;
    bool closed = false;  ///< holds the cloth that it touches
    /// Orientation at the start and at the end of the current step.
    Quat before = Quat::Identity(), after = Quat::Identity();
    double coupling = 0.0;  ///< energy of the coupling at the end of the last step [J]

    bool turns() const { return after.coeffs() != before.coeffs(); }
    void serialize(Archive& archive);
  };
  struct HeldParticle {
    int particle, probe;
    Vec3 offset;  ///< from the proxy [m]
  };
  std::vector<ProbeStep> probe_steps_;
  std::vector<ProbeMemory> memories_;
  std::vector<HeldParticle> held_;
  std::vector<HeldNode> held_nodes_;  ///< held_ by node, for the current step
  /// Particles that pressed on a closed probe in the last step.
  std::vector<std::vector<int>> touched_by_;
  std::vector<int> touched_;         ///< scratch of acceptProbe()
  std::vector<double> proxy_reach_;  ///< largest expected displacement of the proxies [m]
  std::vector<ContactSet::Reach> touching_;
  FineRegions fine_;
  std::vector<LoadEstimate::Touch> touches_;  ///< of loadView()
  double initial_ = 0.0;                      ///< energy at the start [J]
  double supplied_ = 0.0;                     ///< initial_ plus work of devices and obstacles [J]
  double created_ = 0.0;                      ///< by the mesh change of the current step [J]
  double contact_before_ = 0.0;               ///< contact energy at the end of the last step [J]
  double sampled_ = 0.0;                      ///< by the contact samples of the current step [J]
  double let_out_ = 0.0;                      ///< ContactSet::letOutWork() of the last step [J]
  double at_rest_ = 0.0;                      ///< Φ(x⁰) of the current step [J]
  double energy_before_ = 0.0;                ///< energies in Φ(x⁰), minus created() if positive [J]
  Field nodes_, velocities_;
  std::vector<double> reach_;  ///< expected displacement of each node in the current step [m]
  Vector x_, start_, motion_, gradient_, joint_x_;
  /// Directions of the initial guess: inertial motion, and the motion that gravity adds.
  std::array<Vector, 2> ways_;
};

}  // namespace haptic_cloth
