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

/// Formula of one step from x⁰, v⁰ under the forces F of fabric and gravity and C of contact. Contact can
/// stop a node at once, so its forces are impulses; all others follow a backward difference formula. With a⁰
/// what they added to v in the step before, and e⁰ the mean velocity in it minus v⁰:
///
///     a = β a⁰ + σ (F/m − c v),   v = v⁰ + a + h C/m,   e = α (e⁰ − a),   x = x⁰ + h (v + e)
///
/// First order (backward Euler): α = β = 0, σ = h. Second order (BDF2), with r = h over the length of the
/// step before: α = r/(1 + 2r), β = r²/(1 + 2r), σ = h (1 + r)/(1 + 2r); for equal steps 1/3, 1/3 and 2h/3.
/// With equal steps a force of either kind changes Σ m (v + a/2) by h times itself. Where C balances F for
/// long, a is -h C/m, v half of that, and e the opposite of v.
struct BackwardDifference {
  double share;    ///< β [-]
  double carry;    ///< α h [s]
  double span;     ///< σ [s]
  double reach;    ///< σ/(1 + c σ) [s]
  double inertia;  ///< (1 + c σ)/σ² [1/s²]
  double impulse;  ///< λ: displacement by an impulse over that by an equal force of the fabric [-]

  static BackwardDifference euler(double length, double air_damping);
  /// @param length of the step [s]  @param ratio r [-]
  static BackwardDifference bdf2(double length, double ratio, double air_damping);

  /// Motion under no force [m].  @param gained a⁰ [m/s]  @param lag e⁰ [m/s]
  Vec3 inertialMotion(const Vec3& velocity, const Vec3& gained, const Vec3& lag) const {
    return reach * (velocity + share * gained) + carry * (velocity + lag);
  }
};

/// Integrator of all nodes, which all follow one formula. With BDF2 the first step after nothing was kept is
/// one of backward Euler. The velocity of a node that something touched in a step is the mean in it, v + e.
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

  /// Tells whether steps follow the formula of second order.
  bool secondOrder() const { return !first_order_only_; }

  /// Reads what the nodes keep from the step before, and their velocities. Call after each change of the
  /// mesh.
  void gather(const ActiveMesh& mesh, const ParticleState& state, Field& velocities);
  void scatter(const ActiveMesh& mesh, const Field& velocities, ParticleState& state) const;

  /// Motion of a node if no force acts on it in this step [m].
  Vec3 inertialMotion(int node, const Vec3& velocity) const {
    if (first_order_only_) return formula_.reach * velocity;
    return formula_.inertialMotion(velocityBefore(node, velocity), gained_[node], lag_[node]);
  }
  /// Motion of a node that goes on at its velocity, but for the air [m].
  Vec3 coastingMotion(const Vec3& velocity) const {
    return (first_order_only_ ? formula_.reach : length_) * velocity;
  }
  /// Force by which nodes resist a displacement from there, over mass and displacement [1/s²].
  double inertia() const { return formula_.inertia; }

  /// Displacement that a constant acceleration adds in a step, over that acceleration [s²].
  double fall() const { return formula_.reach * formula_.span; }

  /// Factor λ of contact in the potential of a step, which makes its forces impulses [-].
  double contactFactor() const { return formula_.impulse; }

  /// Ends a step: sets the velocities from the positions at its start and end.
  /// @param contact forces of contact on the nodes [N]; read with BDF2 only
  void finish(const ActiveMesh& mesh, const Field& start, const Field& end, const Field& contact,
              Field& velocities);

  /// Ends a step of which only a part was made: the nodes have their mean velocities.
  void finishPart(const Field& start, const Field& end, Field& velocities);

  /// Stops the marked nodes, as if their forces were in balance.
  void stop(const std::vector<char>& nodes, Field& velocities);

  /// Forgets the step before: all nodes rest.
  void stop(Field& velocities);

  /// Slows the free nodes: multiplies velocities and what is kept of the step. Free cloth has a factor of its
  /// own for what moves it as a rigid body.
  /// @param positions of the nodes [m]  @param factor, rigid within 0 to 1
  void slow(const ActiveMesh& mesh, const Field& positions, double factor, double rigid, Field& velocities);

  void serialize(Archive& archive);

 private:
  void setMeanVelocities(const Field& start, const Field& end, Field& velocities) const;
  void forget();
  /// Velocity of a node minus v [m/s].
  Vec3 ahead(int node) const { return pushed_[node].isZero(0.0) ? Vec3(Vec3::Zero()) : lag_[node]; }
  /// v⁰. Where forces balance it depends on the length of the step.
  Vec3 velocityBefore(int node, const Vec3& velocity) const {
    return velocity - ahead(node) - 0.5 * longer_ * pushed_[node];
  }

  bool first_order_only_;
  double length_, air_damping_;  ///< [s], [1/s]
  bool knows_last_ = false;      ///< the nodes keep something of the step before
  double longer_ = 0.0;          ///< length of the step minus that of the step before [s]
  BackwardDifference formula_;   ///< of the current or last step
  Field gained_, lag_;           ///< a⁰ and e⁰ [m/s]
  Field pushed_;                 ///< C/m in the step, but no more than may last [m/s²]
};

}  // namespace haptic_cloth
