#include "sim/time_integrator.h"

#include <algorithm>

#include "sim/rigid_motion.h"

namespace haptic_cloth {
namespace {

/// Steps after which what a force still adds to the velocity by BDF2 is forgotten, as 3⁻¹⁰ of it.
constexpr int kForgotten = 10;

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
      unmixed_(kForgotten),
      first_(BackwardDifference::euler(time_step, air_damping)),
      usual_(first_) {
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->reserve(grid.particles());
  jumps_.reserve(grid.particles());
}

void TimeIntegrator::begin(double length) {
  ratio_ = length / length_;
  first_ = BackwardDifference::euler(length, air_damping_);
  usual_ = knows_last_ ? BackwardDifference::bdf2(length, ratio_, air_damping_) : first_;
  length_ = length;
  std::fill(jumps_.begin(), jumps_.end(), 0);
}

void TimeIntegrator::prepare(ParticleState& state) const {
  if (first_order_only_) return;
  for (auto* list : {&state.moved, &state.gained}) list->assign(state.position.size(), Vec3::Zero());
}

void TimeIntegrator::gather(const ActiveMesh& mesh, const ParticleState& state) {
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) field->resize(mesh.nodes());
  jumps_.assign(mesh.nodes(), 0);
  for (int n = 0; n < mesh.nodes(); ++n) {
    moved_.set(n, state.moved[mesh.particle[n]]);
    gained_.set(n, state.gained[mesh.particle[n]]);
  }
}

void TimeIntegrator::scatter(const ActiveMesh& mesh, ParticleState& state) const {
  if (first_order_only_) return;
  for (int n = 0; n < mesh.nodes(); ++n) {
    state.moved[mesh.particle[n]] = moved_[n];
    state.gained[mesh.particle[n]] = gained_[n];
  }
}

void TimeIntegrator::expectJumps(const std::vector<char>& nodes) {
  for (std::size_t n = 0; n < jumps_.size(); ++n) jumps_[n] |= nodes[n];
  const bool owes = jumping() > 0 || unmixed_ < kForgotten;
  if (ratio_ == 1.0 || !owes) return;
  std::fill(jumps_.begin(), jumps_.end(), 1);
  usual_ = first_;
}

/// Number of nodes that take the step by backward Euler.
int TimeIntegrator::jumping() const {
  return static_cast<int>(std::count_if(jumps_.begin(), jumps_.end(), [](char jumps) { return jumps != 0; }));
}

void TimeIntegrator::finish(const ActiveMesh& mesh, const Field& start, const Field& end, Field& velocities) {
  if (first_order_only_) return setMeanVelocities(start, end, velocities);
  for (int n = 0; n < mesh.active(); ++n) setVelocity(n, end[n] - start[n], velocities);
  for (Field* field : {&velocities, &moved_, &gained_}) mesh.interpolateGhosts(*field);
  knows_last_ = true;
  const int first = jumping();
  unmixed_ = first == mesh.nodes() ? kForgotten : first > 0 ? 0 : std::min(unmixed_ + 1, kForgotten);
}

void TimeIntegrator::finishPart(const ActiveMesh& mesh, const Field& start, const Field& end, double share,
                                Field& velocities) {
  setMeanVelocities(start, end, velocities);
  forget();
  scale(mesh, start, 1.0, 1.0 / share, velocities);
}

void TimeIntegrator::setMeanVelocities(const Field& start, const Field& end, Field& velocities) const {
  for (int c = 0; c < 3; ++c) {
    const auto &x = end.coordinate(c), &before = start.coordinate(c);
    auto& velocity = velocities.coordinate(c);
    for (int n = 0; n < velocities.size(); ++n) velocity[n] = (x[n] - before[n]) / length_;
  }
}

void TimeIntegrator::setVelocity(int n, const Vec3& moved, Field& velocities) {
  const bool jumps = jumps_[n] != 0;
  const BackwardDifference& f = formula(n);
  const Vec3 velocity = (moved - f.share * moved_[n]) / f.span;
  gained_.set(n, jumps ? Vec3(Vec3::Zero()) : Vec3(velocity - velocities[n]));
  moved_.set(n, moved);
  velocities.set(n, velocity);
}

void TimeIntegrator::stop(const std::vector<char>& nodes, Field& velocities) {
  for (int n = 0; n < velocities.size(); ++n) {
    if (nodes[n] == 0) continue;
    velocities.set(n, Vec3::Zero());
    if (first_order_only_) continue;
    for (Field* field : {&moved_, &gained_}) field->set(n, Vec3::Zero());
  }
}

void TimeIntegrator::stop(Field& velocities) {
  velocities.fill(0.0);
  forget();
}

/// Velocities lead on as they are, without a step before.
void TimeIntegrator::forget() {
  knows_last_ = false;
  unmixed_ = kForgotten;
  for (Field* field : {&moved_, &gained_}) field->fill(0.0);
}

void TimeIntegrator::scale(const ActiveMesh& mesh, const Field& positions, double factor, double rigid,
                           Field& velocities) {
  const auto scaleField = [&](Field& field) {
    const RigidMotion whole = mesh.pinned == 0 ? rigidMotion(mesh, positions, field) : RigidMotion();
    for (int n = 0; n < mesh.free; ++n) {
      const Vec3 with_all = whole.at(positions[n]);
      field.set(n, rigid * with_all + factor * (field[n] - with_all));
    }
    mesh.interpolateGhosts(field);
  };
  scaleField(velocities);
  if (first_order_only_) return;
  for (Field* field : {&moved_, &gained_}) scaleField(*field);
}

void TimeIntegrator::serialize(Archive& archive) {
  archive("length", length_);
  if (!first_order_only_) {
    archive("knows_last", knows_last_);
    archive("unmixed", unmixed_);
  }
  archive.check(length_ > 0.0, "length", "must be > 0");
}

}  // namespace haptic_cloth
