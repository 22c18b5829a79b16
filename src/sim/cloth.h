/// The cloth between two steps.
#pragma once

#include <optional>
#include <vector>

#include "energy/history.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"
#include "mesh/active_mesh.h"
#include "mesh/transfer.h"
#include "parallel/parallel_for.h"
#include "sim/adaptation.h"
#include "sim/moving_pins.h"
#include "sim/time_integrator.h"
#include "state/archive.h"

namespace haptic_cloth {

class ClothObjective;

/// Adaptive mesh, state of its nodes, and fabric with its memory. Only a change of the mesh, an
/// accepted step and loading change the state.
class Cloth {
 public:
  static constexpr double kSlow = 1e-3;  ///< rms speed that is not seen [m/s]

  /// Flat cloth at rest.
  explicit Cloth(const Scene& scene);
  Cloth(const Cloth&) = delete;  // its fabric refers to its mesh
  Cloth& operator=(const Cloth&) = delete;

  const Grid& grid() const { return grid_; }
  const LeafMesh& leaves() const { return leaves_; }
  const ActiveMesh& mesh() const { return mesh_; }
  const ParticleState& state() const { return state_; }
  const Field& nodes() const { return nodes_; }            ///< positions [m]
  const Field& velocities() const { return velocities_; }  ///< [m/s]

  const TimeIntegrator& integrator() const { return integrator_; }
  /// Starts a step. @param length [s]  @param end time at its end [s]
  void beginStep(double length, double end) {
    integrator_.begin(length);
    pins_.begin(length, end);
  }
  void setAirDamping(double air_damping) { integrator_.setAirDamping(air_damping); }
  /// Tells the integrator which nodes may touch something in this step.
  void expectJumps(const std::vector<char>& nodes) { integrator_.expectJumps(nodes); }

  bool pinsMove() const { return pins_.any(); }
  int pins() const { return pins_.count(); }  ///< entries of the scene's pins
  /// Sets the nodes of a moving pin to where it is to be at the end of the step.
  void placePin(int pin, Field& nodes) const { pins_.place(pin, mesh_, nodes); }
  /// Notes how far the pins came in the step. @param made share of its motion for each of them [-]
  void advancePins(const std::vector<double>& made) { pins_.advance(made); }

  /// Gravity minus acceleration of the nodes in the last step, along the surface normal [m/s²].
  const std::vector<double>& weight() const { return weight_; }

  /// Elements of the fabric. Evaluations store forces in them; that does not change the cloth.
  InternalEnergy& internal() { return internal_; }
  const InternalEnergy& internal() const { return internal_; }

  /// Places the particles of the finest grid. The next change of the mesh reads these positions, and
  /// the energy that they add counts as created by it.
  void setPositions(const std::vector<Vec3>& positions) { state_.position = positions; }

  /// Turns the surface normals to where the velocities lead the nodes by the middle of the step.
  void updateNormals();

  /// Makes the planned changes of the mesh and hands the state over. @return energy created [J]
  double changeMesh(Adaptation& adaptation, long tick);

  /// Takes positions, velocities and weight from a solved step.
  /// @param share of its motion that was made, > 0 [-]
  void move(const ClothObjective& solved, double share);

  /// Stops the marked nodes where they are.
  void stop(const std::vector<char>& nodes) { integrator_.stop(nodes, velocities_); }

  /// Lowers the kinetic energy to `allowed` [J]. What moves free cloth as a rigid body stays as long as the
  /// rest can pay, because forces within the cloth cannot change it. Pins move on as they are told: only
  /// their share of the energy stays too high.
  /// @return factor of all other velocities
  double limitKineticEnergy(double allowed);

  /// Completes an accepted step: stores the state by particle, and updates the fabric's memory.
  void commit(Team& team);

  /// Stops all nodes where they are.
  void stop();

  double mass() const;                 ///< [kg]
  double maxSpeed() const;             ///< [m/s]
  double kineticEnergy() const;        ///< [J]
  double pinnedKineticEnergy() const;  ///< its part of the pinned nodes [J]
  Vec3 pinnedMomentum() const;         ///< [kg m/s]

  /// Work of gravity on a motion to the positions `to` [J].
  double gravityWork(const Field& to) const;

  /// Kinetic energy and energy of gravity.
  EnergyReport motionEnergy() const;

  /// Stretch, bending and shear energy stored in the fabric [J].
  /// @param potential its part of Φ, which is what a fabric without memory stores
  InternalEnergy::Energy storedEnergy(const InternalEnergy::Energy& potential) const;

  void serialize(Archive& archive);

 private:
  void gatherNodes();
  void takeMesh();
  double rigidKineticEnergy() const;

  Vec3 gravity_;  ///< [m/s²]
  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  ParticleState state_;
  MovingPins pins_;
  Field nodes_, velocities_;  ///< state_ by node
  Field middle_;              ///< nodes in the middle of the step, scratch of updateNormals() [m]
  TimeIntegrator integrator_;
  std::vector<double> weight_;
  InternalEnergy internal_;
  std::optional<ForceHistory> history_;  ///< set for a fabric with hysteresis; scratch of changeMesh()
};

}  // namespace haptic_cloth
