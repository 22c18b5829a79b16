/// The step: how the parts of a simulation make one.
#pragma once

#include <vector>

#include "contact/contact_set.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"
#include "parallel/parallel_for.h"
#include "sim/adaptation.h"
#include "sim/cloth.h"
#include "sim/energy_balance.h"
#include "sim/force_error.h"
#include "sim/grasps.h"
#include "sim/idle_tracker.h"
#include "sim/probes.h"
#include "sim/sleep_tracker.h"
#include "sim/step_solver.h"
#include "sim/turn_estimate.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Cloth, obstacles and probes, and the method that advances them. Simulation wraps this class.
class ClothWorld {
 public:
  /// @pre scene is valid
  explicit ClothWorld(const Scene& scene);
  ClothWorld(const ClothWorld&) = delete;  // parts refer to each other
  ClothWorld& operator=(const ClothWorld&) = delete;

  void setDevice(int probe, const DeviceState& device);
  void removeDevice(int probe);
  void setGrasp(int probe, bool closed);
  bool isClosed(int probe) const { return probes_.isClosed(probe); }
  void moveObstacle(int obstacle, const Pose& pose) { contacts_.moveObstacle(obstacle, pose); }

  /// Places the particles, see Cloth::setPositions().
  void setPositions(const std::vector<Vec3>& positions) { cloth_.setPositions(positions); }

  /// Changes options from the next step on. @pre valid, and options that must not change are the
  /// same
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping);
  void setAdaptOptions(const AdaptOptions& options);
  void setCoupling(int probe, double stiffness, double damping);

  /// @param length of the step in units of the scene's time_step  @pre >= 1
  StepReport step(int length = 1);

  /// Saves or loads everything that later steps and queries read; the rest is scratch or part of
  /// the scene. @pre loading: a world of the same scene that has made no step. If loading throws,
  /// the world must not be used.
  void serialize(Archive& archive);

  const Scene& scene() const { return scene_; }
  const Cloth& cloth() const { return cloth_; }
  const ContactSet& contacts() const { return contacts_; }
  const std::vector<ProbeReport>& probes() const { return probes_.reports(); }
  const ClothObjective& objective() const { return solver_.objective(); }  ///< with the last solution
  const CostReport& cost() const { return solver_.cost(); }
  long steps() const { return steps_; }
  long ticks() const { return ticks_; }  ///< simulated time in units of the scene's time_step
  double time() const { return ticks_ * scene_.solver.time_step; }
  int threads() const { return team_.threads(); }
  Vec3 supportForce() const { return support_force_; }  ///< force of pins and obstacles [N]
  EnergyReport energy() const { return energy_.report(cloth_, solver_.objective()); }

  /// Energy that the mesh change and the contact samples of the last step created [J].
  double created() const { return energy_.created(); }

  /// Inputs of the next mesh decision's load estimate; valid until the next call.
  TurnEstimate::View turnView();

 private:
  friend class ClothCase;  // bench/kernel_times measures single passes

  void takeStep(int length, StepReport& report);
  void adapt(StepReport& report);
  bool planMesh();
  bool solidsMove() const;
  bool feelsCloth() const;
  void accept(StepReport& report);
  void reportPairs(StepReport& report);
  void markDriven();
  void markStopped();
  void restore();
  StepReport skipStep(int length);

  Scene scene_;
  Cloth cloth_;
  Team team_;
  ContactSet contacts_;
  Probes probes_;
  Grasps grasps_;
  Adaptation adaptation_;
  TurnEstimate turns_;
  SleepTracker sleep_;
  StepSolver solver_;
  EnergyBalance energy_;
  ForceError force_error_;
  IdleTracker idle_;
  long steps_ = 0, ticks_ = 0;
  Vec3 support_force_ = Vec3::Zero();
  ProbeRegions near_probes_;                  ///< scratch of planMesh()
  std::vector<TurnEstimate::Touch> touches_;  ///< scratch of turnView()
  std::vector<char> driven_, stopped_;        ///< scratch of accept(): one flag for each node
};

}  // namespace haptic_cloth
