#include "sim/cloth.h"

#include <algorithm>
#include <cmath>

#include "sim/cloth_objective.h"
#include "sim/rigid_motion.h"

namespace haptic_cloth {
namespace {

Grid makeGrid(const Scene& scene) {
  const auto& [columns, rows] = scene.cloth.particles;
  return {columns, rows, scene.adapt.levels, scene.cloth.size[0] / (columns - 1),
          scene.cloth.size[1] / (rows - 1)};
}

ParticleState flatState(const Scene& scene, const Grid& grid) {
  ParticleState state;
  state.position.resize(grid.particles());
  state.velocity.assign(grid.particles(), Vec3::Zero());
  for (int p = 0; p < grid.particles(); ++p) {
    const Vec3 local((grid.column(p) - 0.5 * (grid.columns - 1)) * grid.dx,
                     (grid.row(p) - 0.5 * (grid.rows - 1)) * grid.dy, 0.0);
    state.position[p] = scene.cloth.pose.position + scene.cloth.pose.orientation * local;
  }
  return state;
}

}  // namespace

Cloth::Cloth(const Scene& scene)
    : gravity_(scene.gravity),
      grid_(makeGrid(scene)),
      leaves_(grid_, scene.cloth.pins, Adaptation::startLevel(scene.adapt)),
      mesh_(leaves_, scene.cloth.fabric.areal_density),
      state_(flatState(scene, grid_)),
      pins_(scene.cloth.pins, grid_, state_.position),
      integrator_(scene.solver.integrator, scene.solver.time_step, scene.air_damping, grid_),
      internal_(scene.cloth.fabric, mesh_) {
  if (internal_.hasMemory()) history_.emplace(grid_);
  nodes_.reserve(grid_.particles());
  velocities_.reserve(grid_.particles());
  middle_.reserve(grid_.particles());
  weight_.reserve(grid_.particles());
  integrator_.prepare(state_);
  gatherNodes();
  updateNormals();
  weight_.assign(mesh_.nodes(), 0.0);  // zero as in free fall
}

/// Reads node values from the state by particle.
void Cloth::gatherNodes() {
  nodes_.resize(mesh_.nodes());
  velocities_.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.nodes(); ++n) {
    nodes_.set(n, state_.position[mesh_.particle[n]]);
    velocities_.set(n, state_.velocity[mesh_.particle[n]]);
  }
  mesh_.interpolateGhosts(nodes_);
  mesh_.interpolateGhosts(velocities_);
  integrator_.gather(mesh_, state_);
}

/// Updates everything that depends on the mesh, after a change.
void Cloth::takeMesh() {
  internal_.resize();
  gatherNodes();
  updateNormals();
}

void Cloth::updateNormals() {
  const double half = 0.5 * integrator_.stepLength();
  middle_.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.nodes(); ++n) middle_.set(n, nodes_[n] + half * velocities_[n]);
  internal_.setNormals(middle_);
}

double Cloth::changeMesh(Adaptation& adaptation, long tick) {
  const double before = motionEnergy().total();
  internal_.beginChange(nodes_);
  if (history_) internal_.remember(nodes_, *history_);
  adaptation.apply(tick, leaves_, mesh_, state_);
  takeMesh();
  internal_.endChange(nodes_);
  if (history_) {
    for (const Cell& parent : adaptation.merged()) history_->merge(parent);
    for (const Cell& parent : adaptation.split()) history_->split(parent);
    internal_.recall(nodes_, *history_);
  }
  return motionEnergy().total() - before + internal_.madeByChange(nodes_);
}

void Cloth::move(const ClothObjective& solved, double share) {
  const Field& after = solved.nodes();
  if (share == 1.0) {
    integrator_.finish(mesh_, nodes_, after, velocities_);
  } else {
    integrator_.finishPart(mesh_, nodes_, after, share, velocities_);
  }
  weight_.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.active(); ++n) {
    weight_[n] = -solved.motionGradient(n, after[n]).dot(internal_.normal(n)) / mesh_.mass[n];
  }
  for (const Ghost& g : mesh_.ghosts) weight_[g.node] = 0.5 * (weight_[g.a] + weight_[g.b]);
  nodes_ = after;
}

double Cloth::limitKineticEnergy(double allowed) {
  constexpr double kLeastLeft = 0.25;  // of the energy within the cloth, before the rest pays, too
  const double rigid = rigidKineticEnergy(), inner = kineticEnergy() - rigid;
  const double left = std::max(allowed - rigid, kLeastLeft * inner);
  const double whole = left + rigid > allowed ? std::sqrt(allowed / (left + rigid)) : 1.0;
  const double factor = inner > 0.0 ? whole * std::sqrt(left / inner) : whole;
  integrator_.scale(mesh_, nodes_, factor, whole, velocities_);
  return factor;
}

void Cloth::commit(Team& team) {
  for (int n = 0; n < mesh_.nodes(); ++n) {
    state_.position[mesh_.particle[n]] = nodes_[n];
    state_.velocity[mesh_.particle[n]] = velocities_[n];
  }
  integrator_.scatter(mesh_, state_);
  if (!history_) return;
  team.forRange(internal_.size(), [this](int begin, int end) { internal_.commit(begin, end, nodes_); });
}

void Cloth::stop() {
  integrator_.stop(velocities_);
  integrator_.scatter(mesh_, state_);
  weight_.assign(mesh_.nodes(), 0.0);
  for (int n = 0; n < mesh_.nodes(); ++n) state_.velocity[mesh_.particle[n]] = Vec3::Zero();
}

double Cloth::mass() const {
  double sum = 0.0;
  for (const double m : mesh_.mass) sum += m;
  return sum;
}

double Cloth::maxSpeed() const {
  double largest = 0.0;
  for (int n = 0; n < mesh_.active(); ++n) largest = std::max(largest, velocities_[n].squaredNorm());
  return std::sqrt(largest);
}

double Cloth::kineticEnergy() const {
  double kinetic = 0.0;
  for (int n = 0; n < mesh_.active(); ++n) kinetic += 0.5 * mesh_.mass[n] * velocities_[n].squaredNorm();
  return kinetic;
}

double Cloth::pinnedKineticEnergy() const {
  double kinetic = 0.0;
  for (int n = mesh_.free; n < mesh_.active(); ++n)
    kinetic += 0.5 * mesh_.mass[n] * velocities_[n].squaredNorm();
  return kinetic;
}

/// Kinetic energy of free cloth as a rigid body [J].
double Cloth::rigidKineticEnergy() const {
  if (mesh_.pinned > 0) return 0.0;
  const RigidMotion whole = rigidMotion(mesh_, nodes_, velocities_);
  double energy = 0.0;
  for (int n = 0; n < mesh_.free; ++n) energy += 0.5 * mesh_.mass[n] * whole.at(nodes_[n]).squaredNorm();
  return energy;
}

Vec3 Cloth::pinnedMomentum() const {
  Vec3 momentum = Vec3::Zero();
  for (int n = mesh_.free; n < mesh_.active(); ++n) momentum += mesh_.mass[n] * velocities_[n];
  return momentum;
}

double Cloth::gravityWork(const Field& to) const {
  double work = 0.0;
  for (int n = 0; n < mesh_.active(); ++n) work += mesh_.mass[n] * gravity_.dot(to[n] - nodes_[n]);
  return work;
}

EnergyReport Cloth::motionEnergy() const {
  EnergyReport e;
  e.kinetic = kineticEnergy();
  for (int n = 0; n < mesh_.active(); ++n) e.gravity -= mesh_.mass[n] * gravity_.dot(nodes_[n]);
  return e;
}

InternalEnergy::Energy Cloth::storedEnergy(const InternalEnergy::Energy& potential) const {
  return history_ ? internal_.stored(nodes_) : potential;
}

void Cloth::serialize(Archive& archive) {
  archive("leaves", leaves_);
  archive("particles", state_);
  if (archive.loads()) {
    mesh_.rebuild(leaves_);
    takeMesh();
  }
  // Hanging nodes may differ from the mean of their masters in the last bits.
  archive("nodes", nodes_);
  archive("velocities", velocities_);
  if (archive.loads()) weight_.assign(mesh_.nodes(), 0.0);
  archive("weight", weight_);
  archive("integrator", integrator_);
  archive("pins", pins_);
  archive("fabric", internal_);
}

}  // namespace haptic_cloth
