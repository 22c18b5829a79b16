#include "sim/time_integrator.h"

#include <algorithm>

#include "sim/rigid_motion.h"

namespace haptic_cloth {
namespace {

BackwardDifference formula(double share, double carry, double span, double length, double air_damping) {
  const double reach = span / (1.0 + air_damping * span);
  return {share, carry, span, reach, 1.0 / (reach * span), length * (reach + carry) / (reach * span)};
}

/// The part of contact that may last, over mass, after `pushed` in this step [m/s²]: it may grow from nothing
/// to what carries a weight, and then by a fifth in each step. A blow is more.
Vec3 lasting(const Vec3& before, const Vec3& pushed) {
  constexpr double kWeight = 9.80665, kGrowth = 1.2;
  const double most = std::max(kWeight, kGrowth * before.norm()), size = pushed.norm();
  return size > most ? Vec3(most / size * pushed) : pushed;
}

}  // namespace

BackwardDifference BackwardDifference::euler(double length, double air_damping) {
  return formula(0.0, 0.0, length, length, air_damping);
}

BackwardDifference BackwardDifference::bdf2(double length, double ratio, double air_damping) {
  const double whole = 1.0 + 2.0 * ratio;
  return formula(ratio * ratio / whole, length * ratio / whole, length * (1.0 + ratio) / whole, length,
                 air_damping);
}

TimeIntegrator::TimeIntegrator(Integrator kind, double time_step, double air_damping, const Grid& grid)
    : first_order_only_(kind == Integrator::Euler),
      length_(time_step),
      air_damping_(air_damping),
      formula_(BackwardDifference::euler(time_step, air_damping)) {
  if (first_order_only_) return;
  for (Field* field : {&gained_, &lag_, &pushed_}) field->reserve(grid.particles());
}

void TimeIntegrator::begin(double length) {
  formula_ = knows_last_ ? BackwardDifference::bdf2(length, length / length_, air_damping_)
                         : BackwardDifference::euler(length, air_damping_);
  longer_ = knows_last_ ? length - length_ : 0.0;
  length_ = length;
}

void TimeIntegrator::prepare(ParticleState& state) const {
  if (first_order_only_) return;
  for (auto* list : {&state.gained, &state.lag, &state.pushed})
    list->assign(state.position.size(), Vec3::Zero());
}

void TimeIntegrator::gather(const ActiveMesh& mesh, const ParticleState& state, Field& velocities) {
  for (int n = 0; n < mesh.nodes(); ++n) velocities.set(n, state.velocity[mesh.particle[n]]);
  if (first_order_only_) return;
  for (Field* field : {&gained_, &lag_, &pushed_}) field->resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    gained_.set(n, state.gained[p]);
    lag_.set(n, state.lag[p]);
    pushed_.set(n, state.pushed[p]);
    velocities.add(n, ahead(n));
  }
}

void TimeIntegrator::scatter(const ActiveMesh& mesh, const Field& velocities, ParticleState& state) const {
  for (int n = 0; n < mesh.nodes(); ++n) state.velocity[mesh.particle[n]] = velocities[n];
  if (first_order_only_) return;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    state.gained[p] = gained_[n];
    state.lag[p] = lag_[n];
    state.pushed[p] = pushed_[n];
    state.velocity[p] -= ahead(n);
  }
  for (const Ghost& g : mesh.ghosts) {
    const int a = mesh.particle[g.a], b = mesh.particle[g.b];
    state.velocity[mesh.particle[g.node]] = 0.5 * (state.velocity[a] + state.velocity[b]);
  }
}

void TimeIntegrator::finish(const ActiveMesh& mesh, const Field& start, const Field& end,
                            const Field& contact, Field& velocities) {
  if (first_order_only_) return setMeanVelocities(start, end, velocities);
  for (int n = 0; n < mesh.active(); ++n) {
    const Vec3 moved = end[n] - start[n];
    const Vec3 pushed = n < mesh.free ? Vec3(contact[n] / mesh.mass[n]) : Vec3(Vec3::Zero());
    const Vec3 before = velocityBefore(n, velocities[n]) + length_ * pushed;
    const Vec3 velocity = (moved - formula_.carry * (before + lag_[n])) / formula_.span;
    gained_.set(n, velocity - before);
    lag_.set(n, moved / length_ - velocity);
    pushed_.set(n, lasting(pushed_[n], pushed));
    velocities.set(n, velocity + ahead(n));
  }
  for (Field* field : {&velocities, &gained_, &lag_, &pushed_}) mesh.interpolateGhosts(*field);
  knows_last_ = true;
}

void TimeIntegrator::finishPart(const Field& start, const Field& end, Field& velocities) {
  setMeanVelocities(start, end, velocities);
  forget();
}

void TimeIntegrator::setMeanVelocities(const Field& start, const Field& end, Field& velocities) const {
  for (int c = 0; c < 3; ++c) {
    const auto &x = end.coordinate(c), &before = start.coordinate(c);
    auto& velocity = velocities.coordinate(c);
    for (int n = 0; n < velocities.size(); ++n) velocity[n] = (x[n] - before[n]) / length_;
  }
}

void TimeIntegrator::stop(const std::vector<char>& nodes, Field& velocities) {
  for (int n = 0; n < velocities.size(); ++n) {
    if (nodes[n] == 0) continue;
    velocities.set(n, Vec3::Zero());
    if (first_order_only_) continue;
    gained_.set(n, -length_ * pushed_[n]);
    lag_.set(n, 0.5 * length_ * pushed_[n]);
  }
}

void TimeIntegrator::stop(Field& velocities) {
  velocities.fill(0.0);
  forget();
}

void TimeIntegrator::forget() {
  knows_last_ = false;
  for (Field* field : {&gained_, &lag_, &pushed_}) field->fill(0.0);
}

void TimeIntegrator::slow(const ActiveMesh& mesh, const Field& positions, double factor, double rigid,
                          Field& velocities) {
  const auto slowField = [&](Field& field) {
    const RigidMotion whole = mesh.pinned == 0 ? rigidMotion(mesh, positions, field) : RigidMotion();
    for (int n = 0; n < mesh.free; ++n) {
      const Vec3 with_all = whole.at(positions[n]);
      field.set(n, rigid * with_all + factor * (field[n] - with_all));
    }
    mesh.interpolateGhosts(field);
  };
  slowField(velocities);
  if (first_order_only_) return;
  const auto shift = [&](double time) {
    for (int n = 0; n < mesh.nodes(); ++n) {
      gained_.add(n, time * pushed_[n]);
      lag_.add(n, -0.5 * time * pushed_[n]);
    }
  };
  shift(length_);  // to what is left where forces balance
  for (Field* field : {&gained_, &lag_}) slowField(*field);
  shift(-length_);
}

void TimeIntegrator::serialize(Archive& archive) {
  archive("length", length_);
  if (!first_order_only_) archive("knows_last", knows_last_);
  archive.check(length_ > 0.0, "length", "must be > 0");
}

}  // namespace haptic_cloth
