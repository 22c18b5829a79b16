#include "sim/time_integrator.h"

#include <algorithm>

#include "sim/rigid_motion.h"

namespace haptic_cloth {
namespace {

// If less of the velocity is left, the step before says nothing about the next one [-].
constexpr double kStillSmooth = 0.5;

BackwardDifference formula(double share, double span, double air_damping) {
  return {share, span, span / (1.0 + air_damping * span), (1.0 + air_damping * span) / (span * span)};
}

}  // namespace

BackwardDifference BackwardDifference::euler(double length, double air_damping) {
  return formula(0.0, length, air_damping);
}

BackwardDifference BackwardDifference::bdf2(double length, double ratio, double air_damping) {
  const double whole = 1.0 + 2.0 * ratio;
  return formula(ratio * ratio / whole, length * (1.0 + ratio) / whole, air_damping);
}

TimeIntegrator::TimeIntegrator(Integrator kind, double time_step, double air_damping, const Grid& grid)
    : first_order_only_(kind == Integrator::Euler),
      length_(time_step),
      air_damping_(air_damping),
      first_(BackwardDifference::euler(time_step, air_damping)),
      second_(BackwardDifference::bdf2(time_step, 1.0, air_damping)) {
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->reserve(grid.particles());
  jumped_.reserve(grid.particles());
}

void TimeIntegrator::begin(double length) {
  first_ = BackwardDifference::euler(length, air_damping_);
  second_ = BackwardDifference::bdf2(length, length / length_, air_damping_);
  length_ = length;
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

void TimeIntegrator::expectJumps(const std::vector<char>& nodes) {
  for (std::size_t n = 0; n < jumped_.size(); ++n) jumped_[n] |= nodes[n];
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
    for (int n = 0; n < velocities.size(); ++n) velocity[n] = (x[n] - before[n]) / length_;
  }
}

void TimeIntegrator::setVelocity(int n, const Vec3& moved, bool jumped, Field& velocities) {
  const BackwardDifference& f = formula(n);
  const Vec3 velocity = jumped ? Vec3(moved / length_) : Vec3((moved - f.share * moved_[n]) / f.span);
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

void TimeIntegrator::slow(const ActiveMesh& mesh, const Field& positions, double factor, double rigid,
                          Field& velocities) {
  const auto slowField = [&](Field& field, const auto& note) {
    const RigidMotion whole = mesh.pinned == 0 ? rigidMotion(mesh, positions, field) : RigidMotion();
    for (int n = 0; n < mesh.free; ++n) {
      const Vec3 before = field[n], with_all = whole.at(positions[n]);
      field.set(n, rigid * with_all + factor * (before - with_all));
      note(n, before);
    }
    mesh.interpolateGhosts(field);
  };
  slowField(velocities, [&](int n, const Vec3& before) {
    if (!first_order_only_ && velocities[n].norm() < kStillSmooth * before.norm()) jumped_[n] = 1;
  });
  if (first_order_only_) return;
  for (const Ghost& g : mesh.ghosts) jumped_[g.node] = jumped_[g.a] | jumped_[g.b];
  for (Field* field : {&moved_, &gained_}) slowField(*field, [](int, const Vec3&) {});
}

void TimeIntegrator::serialize(Archive& archive) {
  archive("length", length_);
  archive.check(length_ > 0.0, "length", "must be > 0");
}

}  // namespace haptic_cloth
