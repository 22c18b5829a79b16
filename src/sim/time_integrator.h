/// Time integration: where inertia alone carries the nodes in a step, how they resist being moved from
/// there, and their velocities at the end.
#pragma once

#include <vector>

#include "haptic_cloth/options.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "mesh/transfer.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Backward difference formula of one step from x⁰, v⁰, with Δx and Δv the changes of x and v in the
/// step before:
///
///     x̂ = x⁰ + β Δx,   v̂ = v⁰ + β Δv,   x = x̂ + σ v,   v = v̂ + σ (F/m − c v)
///
/// First order (backward Euler): β = 0, σ = h. Second order (BDF2), with r = h over the length of the
/// step before: β = r²/(1 + 2r), σ = h (1 + r)/(1 + 2r); for equal steps 1/3 and 2h/3.
struct BackwardDifference {
  double share;    ///< β [-]
  double span;     ///< σ [s]
  double reach;    ///< σ/(1 + c σ) [s]
  double inertia;  ///< (1 + c σ)/σ² [1/s²]

  static BackwardDifference euler(double length, double air_damping);
  /// @param length of the step [s]  @param ratio r [-]
  static BackwardDifference bdf2(double length, double ratio, double air_damping);

  Vec3 inertialMotion(const Vec3& velocity, const Vec3& moved, const Vec3& gained) const {
    return share * moved + reach * (velocity + share * gained);
  }
};

/// Integrator of all nodes. With BDF2 nodes that may touch something take a step of backward Euler, because
/// the formula takes a jump of velocity for smooth motion: it would throw the node back. A force changes Σ m
/// (v + Δv/2) by h times itself with equal steps of BDF2, and Σ m v with backward Euler. So a node goes over
/// with the velocity v + Δv/2, and back with Δv = 0; then opposite forces keep momentum whatever the nodes
/// follow. A step of another length than the one before keeps no such sum. So if any node touches something
/// in it, or did a short time before, all take it by backward Euler; as they do in the first step from a
/// state of which nothing is kept.
class TimeIntegrator {
 public:
  /// @param time_step usual length of a step [s]
  TimeIntegrator(Integrator kind, double time_step, double air_damping, const Grid& grid);

  /// Takes effect with the next step.
  void setAirDamping(double air_damping) { air_damping_ = air_damping; }

  /// Starts a step. @param length [s]
  void begin(double length);

  double stepLength() const { return length_; }  ///< of the current or last step [s]

  /// Gives the particles what they keep of a step, as for a cloth that has made none.
  void prepare(ParticleState& state) const;

  /// Tells whether any node follows the formula of second order.
  bool secondOrder() const { return !first_order_only_; }

  /// Lets the marked nodes take this step by backward Euler, as well as those marked before in the step.
  void expectJumps(const std::vector<char>& nodes);

  /// Reads what the nodes keep from the step before. Call after each change of the mesh.
  void gather(const ActiveMesh& mesh, const ParticleState& state);
  void scatter(const ActiveMesh& mesh, ParticleState& state) const;

  /// Motion of a node if no force acts on it in this step [m].
  Vec3 inertialMotion(int node, const Vec3& velocity) const {
    if (first_order_only_) return first_.reach * velocity;
    if (jumps_[node] != 0) return first_.reach * (velocity + 0.5 * gained_[node]);
    return usual_.inertialMotion(velocity, moved_[node], gained_[node]);
  }
  /// Force by which a node resists a displacement from there, over mass and displacement [1/s²].
  double inertia(int node) const { return formula(node).inertia; }
  double inertia() const { return usual_.inertia; }  ///< of nodes that do not jump [1/s²]

  /// Displacement that a constant acceleration adds in a step, over that acceleration [s²].
  double fall() const { return usual_.reach * usual_.span; }

  /// Ends a step: sets the velocities from the positions at its start and end.
  void finish(const ActiveMesh& mesh, const Field& start, const Field& end, Field& velocities);

  /// Ends a step of which only a part was made: the nodes have their mean velocities. Free cloth moves on as
  /// a rigid body as fast as in the whole motion: where parts of it meet, neither momentum nor spin is lost.
  /// @param share of the motion that was made, > 0 [-]
  void finishPart(const ActiveMesh& mesh, const Field& start, const Field& end, double share,
                  Field& velocities);

  /// Stops the marked nodes.
  void stop(const std::vector<char>& nodes, Field& velocities);

  /// Forgets the step before: all nodes rest.
  void stop(Field& velocities);

  /// Multiplies velocities of the free nodes and what is kept of the step. Free cloth has a factor of its
  /// own, `rigid`, for what moves it as a rigid body.
  /// @param positions of the nodes [m]
  void scale(const ActiveMesh& mesh, const Field& positions, double factor, double rigid, Field& velocities);

  void serialize(Archive& archive);

 private:
  void setMeanVelocities(const Field& start, const Field& end, Field& velocities) const;
  void setVelocity(int node, const Vec3& moved, Field& velocities);
  void forget();
  int jumping() const;
  const BackwardDifference& formula(int node) const {
    return first_order_only_ || jumps_[node] != 0 ? first_ : usual_;
  }

  bool first_order_only_;
  double length_, air_damping_;       ///< [s], [1/s]
  bool knows_last_ = false;           ///< the nodes keep something of the step before; never without BDF2
  int unmixed_;                       ///< steps since nodes followed different formulas, up to a limit
  double ratio_ = 1.0;                ///< of the length of the current step to that of the one before [-]
  BackwardDifference first_, usual_;  ///< of nodes that jump in the step, and of all others
  Field moved_, gained_;              ///< Δx and Δv of the nodes [m], [m/s]
  std::vector<char> jumps_;           ///< flags of the nodes that take the current step by backward Euler
};

}  // namespace haptic_cloth
