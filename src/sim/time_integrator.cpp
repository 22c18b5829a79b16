#include "sim/time_integrator.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

// If less of the velocity is left, the step before says nothing about the next one [-].
constexpr double kStillSmooth = 0.5;

}  // namespace

BackwardDifference::BackwardDifference(int order, double time_step, double air_damping)
    : share(order == 1 ? 0.0 : 1.0 / 3.0),
      span(order == 1 ? time_step : 2.0 * time_step / 3.0),
      reach(span / (1.0 + air_damping * span)),
      inertia((1.0 + air_damping * span) / (span * span)) {}

TimeIntegrator::TimeIntegrator(Integrator kind, double time_step, double air_damping, const Grid& grid)
    : first_order_only_(kind == Integrator::Euler),
      time_step_(time_step),
      first_(1, time_step, air_damping),
      second_(2, time_step, air_damping) {
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->reserve(grid.particles());
  jumped_.reserve(grid.particles());
}

void TimeIntegrator::setAirDamping(double air_damping) {
  first_ = BackwardDifference(1, time_step_, air_damping);
  second_ = BackwardDifference(2, time_step_, air_damping);
}

void TimeIntegrator::prepare(ParticleState& state) const {
  if (first_order_only_) return;
  for (auto* list : {&state.moved, &state.gained}) list->assign(state.position.size(), Vec3::Zero());
  state.jumped.assign(state.position.size(), 1);
}

void TimeIntegrator::gather(const ActiveMesh& mesh, const ParticleState& state) {
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->resize(mesh.nodes());
  jumped_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    moved_.set(n, state.moved[p]);
    gained_.set(n, state.gained[p]);
    jumped_[n] = state.jumped[p];
  }
}

void TimeIntegrator::scatter(const ActiveMesh& mesh, ParticleState& state) const {
  if (first_order_only_) return;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    state.moved[p] = moved_[n];
    state.gained[p] = gained_[n];
    state.jumped[p] = jumped_[n];
  }
}

void TimeIntegrator::finish(const ActiveMesh& mesh, const Field& start, const Field& end,
                            const std::vector<char>& jumped, Field& velocities) {
  if (first_order_only_) return setMeanVelocities(start, end, velocities);
  for (int n = 0; n < mesh.active(); ++n) setVelocity(n, end[n] - start[n], jumped[n] != 0, velocities);
  followMasters(mesh, velocities);
}

void TimeIntegrator::setMeanVelocities(const Field& start, const Field& end, Field& velocities) const {
  for (int c = 0; c < 3; ++c) {
    const auto &x = end.coordinate(c), &before = start.coordinate(c);
    auto& velocity = velocities.coordinate(c);
    for (int n = 0; n < velocities.size(); ++n) velocity[n] = (x[n] - before[n]) / time_step_;
  }
}

void TimeIntegrator::setVelocity(int n, const Vec3& moved, bool jumped, Field& velocities) {
  const BackwardDifference& f = formula(n);
  const Vec3 velocity = jumped ? Vec3(moved / time_step_) : Vec3((moved - f.share * moved_[n]) / f.span);
  gained_.set(n, velocity - velocities[n]);
  moved_.set(n, moved);
  jumped_[n] = jumped ? 1 : 0;
  velocities.set(n, velocity);
}

/// Gives hanging nodes the means of their masters.
void TimeIntegrator::followMasters(const ActiveMesh& mesh, Field& velocities) {
  for (Field* field : {&velocities, &moved_, &gained_}) mesh.interpolateGhosts(*field);
  for (const Ghost& g : mesh.ghosts) jumped_[g.node] = jumped_[g.a] | jumped_[g.b];
}

void TimeIntegrator::stop(Field& velocities) {
  velocities.fill(0.0);
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->fill(0.0);
  std::fill(jumped_.begin(), jumped_.end(), 1);
}

void TimeIntegrator::slow(double factor, Field& velocities) {
  for (int n = 0; n < velocities.size(); ++n) {
    velocities.set(n, factor * velocities[n]);
    if (first_order_only_) continue;
    moved_.set(n, factor * moved_[n]);
    gained_.set(n, factor * gained_[n]);
    if (factor < kStillSmooth) jumped_[n] = 1;
  }
}

}  // namespace haptic_cloth
