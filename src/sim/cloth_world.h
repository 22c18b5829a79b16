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
#include "solver/minimizer.h"

namespace haptic_cloth {

/// Cloth, obstacles and probe: state, scratch and the method. Simulation wraps it.
class ClothWorld {
 public:
  /// @pre scene is valid
  explicit ClothWorld(const Scene& scene);

  void setDevice(const Vec3& position, const Vec3& velocity);
  void removeDevice();
  StepReport step();

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
  ProbeReport probe;
  Vec3 support_force = Vec3::Zero();
  long steps = 0;

  double time() const { return steps * scene.solver.time_step; }
  double mass() const;
  EnergyReport energy() const;
  double maxSpeed() const;
  const Field& nodes() const { return nodes_; }

 private:
  bool isIdle() const;
  StepReport idle();
  void noteIdle(const StepReport& report);
  void forgetIdle() {
    quiet_ = 0;
    idle_ = false;
  }
  void gatherNodes();
  void adapt(StepReport& report);
  void solve(StepReport& report);
  void findContacts(double proxy_reach);
  MinimizerReport minimise();
  MinimizerReport minimiseJoint();
  void lookAtRest();
  double chooseStart();
  std::array<double, 2> stepsAlongWays();
  bool covered();
  void accept(StepReport& report);
  void restore();
  double guardEnergy(double left);
  void account();
  double kineticEnergy() const;  ///< [J]
  EnergyReport measureMotion() const;
  double cohesion() const;

  Adaptation adaptation_;
  Rest rest_;
  Field forces_;                         ///< on the nodes at rest, for rest_ [N]
  int quiet_ = 0;                        ///< steps in a row in which all slept and no input changed
  bool idle_ = false;                    ///< enough of them
  bool idle_present_ = false;            ///< the probe then,
  Vec3 idle_device_ = Vec3::Zero();      ///< and its device [m]
  double idle_residual_ = 0.0;           ///< of the last step that was solved
  std::optional<ForceHistory> history_;  ///< of a fabric with hysteresis
  std::optional<JointObjective> joint_;  ///< where the scene asks for that cost
  Minimizer minimizer_;
  ProbeStep probe_step_;
  bool probe_entered_ = false;  ///< the probe has been clear of the cloth once; before, it touches nothing
  double supplied_ = 0.0;       ///< energy at the start and what the device has worked since [J]
  double coupling_ = 0.0;       ///< of the coupling at the end of the last step [J]
  double created_ = 0.0;        ///< by the mesh change of the step in hand [J]
  double at_rest_ = 0.0;        ///< Φ of the step in hand with all at rest [J]
  double energy_before_ = 0.0;  ///< Φ's energies at the start of the step in hand, with its inputs [J]
  Field nodes_, velocities_;
  std::vector<double> reach_;  ///< how far a node is expected to move in the step in hand [m]
  Vector x_, start_, motion_, gradient_, joint_x_;
  std::array<Vector, 2> ways_;  ///< inertial motion, and what gravity adds to it
};

}  // namespace haptic_cloth
