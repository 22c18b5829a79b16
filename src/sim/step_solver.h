/// Solves a step: minimises its potential.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "contact/contact_set.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"
#include "sim/cloth.h"
#include "sim/cloth_objective.h"
#include "sim/contact_reach.h"
#include "sim/joint_objective.h"
#include "sim/probes.h"
#include "sim/sleep_tracker.h"
#include "solver/minimizer.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Finds contacts, chooses an initial guess, wakes sleeping nodes that are pushed, and minimises.
/// The result is in objective(); cloth and probes do not move.
class StepSolver {
 public:
  /// Evaluates the cloth where it is. The arguments must outlive this object.
  StepSolver(const Scene& scene, Cloth& cloth, ContactSet& contacts, Probes& probes, SleepTracker& sleep,
             Team& team);

  /// Changes take effect with the next step.
  void setOptions(const MinimizerOptions& options) { minimizer_.setOptions(options); }
  void setCoupling(int probe, double stiffness, double damping) {
    objective_.setCoupling(probe, stiffness, damping);
  }

  /// Must follow a change of the mesh.
  void resize();

  /// Starts the time limit of a step.
  void startBudget() { minimizer_.startBudget(); }

  /// Solves a step from the current state of cloth and probes. If something moved farther than contacts were
  /// searched, the step is solved again; in the end only a part of the motion may be left.
  MinimizerReport solve(const std::vector<HeldNode>& held);

  /// Share of its way in the step that each pin made [-].
  const std::vector<double>& pinsMade() const { return pins_made_; }

  /// Returns to the start of the step, after a solve that failed.
  void restore() {
    objective_.setPinned(cloth_.nodes());
    evaluateStart();
  }

  /// Values where the last step started; Φ with the pins where they end.
  struct Start {
    double potential = 0.0;  ///< Φ(x⁰) [J]
    double energy = 0.0;     ///< energies in Φ(x⁰) [J]
    double friction = 0.0;   ///< potential of friction at x⁰ [J]
    double contact = 0.0;    ///< contact energy [J]
    double layers = 0.0;     ///< part of it: of layers of the cloth [J]
  };
  const Start& start() const { return start_values_; }

  ClothObjective& objective() { return objective_; }
  const ClothObjective& objective() const { return objective_; }  ///< with the solution
  const CostReport& cost() const { return cost_; }                ///< of the last solve

  /// Saves or loads the costs of the last solve.
  void serializeCost(Archive& archive);

 private:
  void findContacts();
  double evaluateStart();
  void foreseeTouches(const std::vector<HeldNode>& held);
  void beginSolve(const std::vector<HeldNode>& held);
  void movePins();
  bool stopPins();
  bool crosses() const;
  void shortenMotion(MinimizerReport& report);
  MinimizerReport minimizeCondensed();
  MinimizerReport minimizeJoint();
  bool moves() const;
  bool markCarried();
  bool wakeDisturbed();
  bool balanceAfter(const MinimizerReport& report, double& value);
  bool balanceNetForce(double& value, int trials = 1,
                       double most_residual = std::numeric_limits<double>::infinity());

  /// Minimum of a quadratic model of Φ at x⁰.
  struct ModelMinimum {
    double inertial, fall;     ///< factors of both directions
    double fall_with_inertia;  ///< the factor of gravity's direction if that of inertia's is one
  };
  double chooseInitialGuess();
  bool netForceStandsOut() const;
  double takeIfLower(Vector& other, double value);
  bool goWithObstacle(Vector& x);
  void goAlongDirections(double inertial, double fall, Vector& x);
  void goAlongMotion(Vector& x);
  ModelMinimum minimumOfModel();

  const Scene& scene_;
  Cloth& cloth_;
  ContactSet& contacts_;
  Probes& probes_;
  SleepTracker& sleep_;
  Team& team_;
  ClothObjective objective_;
  std::optional<JointObjective> joint_;  ///< set for the joint cost
  Minimizer minimizer_;
  ContactReach reach_;
  Start start_values_;
  CostReport cost_;
  Field forces_;               ///< negative forces on the nodes at rest, for sleep_ [N]
  Field pinned_;               ///< scratch: positions with the pins where they end [m]
  Field end_;                  ///< scratch: ends of motions, or motions [m]
  std::vector<char> touched_;  ///< scratch of foreseeTouches() and markCarried(): a flag for each node
  std::vector<double> pins_made_;
  std::vector<char> pins_go_;  ///< pins that nothing has stopped in this step
  Vector x_, start_, motion_, gradient_, joint_x_;
  /// Directions of the initial guess: inertial motion, and the motion that gravity adds.
  std::array<Vector, 2> directions_;
};

}  // namespace haptic_cloth
