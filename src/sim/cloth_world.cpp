#include "sim/cloth_world.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

constexpr double kSlipSpeed =
    3e-4;  // friction grows in below this speed [m/s]: held cloth creeps at most so fast
constexpr double kFineReach = 2.0;  // finest cells around the probe, beyond its radius [finest spacings]

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

ContactSet::Options contactOptions(const Scene& scene) {
  return {scene.cloth.fabric.thickness, kSlipSpeed, scene.solver.time_step, scene.probe.radius,
          scene.probe.friction};
}

}  // namespace

ClothWorld::ClothWorld(const Scene& s)
    : scene(s),
      grid(makeGrid(s)),
      leaves(grid, s.cloth.pins, Adaptation::startLevel(s.adapt)),
      mesh(leaves, s.cloth.fabric.areal_density),
      state(flatState(s, grid)),
      internal(s.cloth.fabric, mesh),
      contacts(grid, s.obstacles, contactOptions(s)),
      team(s.solver.threads),
      objective(s, mesh, internal, contacts, team),
      adaptation_(s.adapt, grid),
      rest_(grid, s.solver.cost == Cost::Condensed ? s.solver.sleep_speed : 0.0),
      minimizer_(s.solver.minimizer) {
  if (internal.hasMemory()) history_.emplace(grid);
  nodes_.reserve(grid.particles());
  reach_.reserve(grid.particles());
  forces_.reserve(grid.particles());
  velocities_.reserve(grid.particles());
  for (Vector* v : {&x_, &start_, &ways_[0], &ways_[1], &motion_, &gradient_})
    v->setZero(objective.capacity());
  if (s.solver.cost == Cost::Joint) {
    joint_.emplace(objective, mesh, internal, contacts, team);
    joint_x_.setZero(joint_->capacity());
  }
  minimizer_.reserve(joint_ ? joint_->capacity() : objective.capacity());
  gatherNodes();
  internal.setNormals(nodes_);
  reach_.assign(mesh.nodes(), 0.0);
  findContacts(0.0);  // a cloth that starts in contact has energy there
  objective.begin(nodes_, velocities_, probe_step_);
  objective.pack(nodes_, probe_step_.proxy, start_);
  objective.evaluate(start_, gradient_);
  supplied_ = energy().total();
}

void ClothWorld::setDevice(const Vec3& position, const Vec3& velocity) {
  if (!position.allFinite() || !velocity.allFinite()) return;
  if (!probe_step_.present) {
    probe_step_.proxy = position;
    probe.proxy = position;
    probe.velocity = Vec3::Zero();
    probe_entered_ = false;
  }
  probe_step_.present = true;
  probe_step_.device = position;
  probe_step_.device_velocity = velocity;
  probe.present = true;
  probe.device = position;
}

void ClothWorld::removeDevice() {
  probe_step_ = ProbeStep();
  probe = ProbeReport();
  forgetIdle();  // one that comes back at once, where this one stood, is another probe
}

StepReport ClothWorld::step() {
  StepReport report;
  if (isIdle()) return idle();
  adapt(report);
  solve(report);
  if (report.minimizer.why == Termination::NotFinite) {
    report.failed = true;
    restore();
  } else {
    accept(report);
  }
  account();
  ++steps;
  report.time = time();
  report.active_particles = mesh.active();
  report.awake_particles = objective.awake();
  noteIdle(report);
  return report;
}

/// All sleeps, and the device is where it was then: nothing would change.
bool ClothWorld::isIdle() const {
  return idle_ && probe_step_.present == idle_present_ &&
         (!idle_present_ || (probe_step_.device == idle_device_ && probe_step_.device_velocity.isZero(0.0)));
}

StepReport ClothWorld::idle() {
  StepReport report;
  report.minimizer.residual = idle_residual_;
  ++steps;
  report.time = time();
  report.active_particles = mesh.active();
  return report;
}

/// Whether the next steps may be left out if no input changes.
void ClothWorld::noteIdle(const StepReport& report) {
  const bool proxy_rests = !probe_step_.present || probe.velocity.norm() < scene.solver.sleep_speed;
  const bool moved = probe_step_.present != idle_present_ || probe_step_.device != idle_device_;
  const bool changed = moved || report.refined > 0 || report.coarsened > 0 || report.failed;
  quiet_ = objective.awake() == 0 && proxy_rests && !changed ? quiet_ + 1 : 0;
  idle_ = quiet_ >= Rest::kSteps;  // the mesh has had time to want a change
  idle_present_ = probe_step_.present;
  idle_device_ = probe_step_.device;
  idle_residual_ = report.minimizer.residual;
}

/// Node values from the finest-grid state.
void ClothWorld::gatherNodes() {
  nodes_.resize(mesh.nodes());
  velocities_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    nodes_.set(n, state.position[mesh.particle[n]]);
    velocities_.set(n, state.velocity[mesh.particle[n]]);
  }
  mesh.interpolateGhosts(nodes_);
  mesh.interpolateGhosts(velocities_);
}

void ClothWorld::adapt(StepReport& report) {
  const double spacing = std::max(grid.dx, grid.dy);
  const double ahead = std::min((probe_step_.device - probe_step_.proxy).norm(), kFineReach * spacing);
  const FineRegion fine{probe_step_.proxy, scene.probe.radius + kFineReach * spacing + ahead};
  const FineRegion* near = probe_step_.present ? &fine : nullptr;
  created_ = 0.0;
  if (!adaptation_.plan(steps, nodes_, internal, near, leaves, mesh, state)) {
    internal.setNormals(nodes_);
    return;
  }
  const double before = cohesion();
  if (history_) internal.remember(nodes_, *history_);
  adaptation_.apply(steps, near, leaves, mesh, state);
  report.refined = static_cast<int>(adaptation_.split().size());
  report.coarsened = static_cast<int>(adaptation_.merged().size());
  for (const Cell& cell : adaptation_.merged()) rest_.disturb(grid, cell);
  for (const Cell& cell : adaptation_.split()) rest_.disturb(grid, cell);
  internal.resize();
  gatherNodes();
  internal.setNormals(nodes_);
  if (history_) {
    for (const Cell& parent : adaptation_.merged()) history_->merge(parent);
    for (const Cell& parent : adaptation_.split()) history_->split(parent);
    internal.recall(nodes_, *history_);
  }
  created_ = cohesion() - before;
}

void ClothWorld::accept(StepReport& report) {
  const double h = scene.solver.time_step;
  const Field& after = objective.nodes();
  const double kinetic_before = kineticEnergy();
  double gravity_work = 0.0;
  for (int n = 0; n < mesh.active(); ++n) {
    gravity_work += mesh.mass[n] * scene.gravity.dot(after[n] - nodes_[n]);
  }
  for (int n = 0; n < mesh.nodes(); ++n) velocities_.set(n, (after[n] - nodes_[n]) / h);
  nodes_ = after;
  contacts.calm(velocities_);
  rest_.update(
      mesh, velocities_, [this](int n) { return objective.isAwake(n); },
      [this](int n) { return objective.isDisturbed(n); });

  Sums parts;
  const double spent =
      objective.internalEnergy(parts) + objective.couplingEnergy() + objective.lossPotential();
  report.velocity_scale = guardEnergy(energy_before_ + kinetic_before + gravity_work - spent);
  for (int n = 0; n < mesh.nodes(); ++n) {
    state.position[mesh.particle[n]] = nodes_[n];
    state.velocity[mesh.particle[n]] = velocities_[n];
  }
  if (probe_step_.present) {
    probe.proxy = objective.proxy();
    probe.velocity = (objective.proxy() - probe_step_.proxy) / h;
    probe.force = Vec3::Zero() - contacts.proxyGradient();
    probe.contact = contacts.probeTouched();
    probe_step_.proxy = probe.proxy;
  }
  if (history_) {
    team.forRange(internal.elements(), [this](int begin, int end) { internal.commit(begin, end, nodes_); });
  }
  support_force = contacts.obstacleForce() + objective.pinForce();
  report.max_penetration = contacts.deepest();
}

/// Back to the start of the step, at rest: the one state known to be good.
void ClothWorld::restore() {
  velocities_.fill(0.0);
  for (int n = 0; n < mesh.nodes(); ++n) state.velocity[mesh.particle[n]] = Vec3::Zero();
  objective.pack(nodes_, probe_step_.proxy, start_);
  objective.evaluate(start_, gradient_);
  probe.velocity = Vec3::Zero();
  probe.force = Vec3::Zero();
  probe.contact = false;
}

double ClothWorld::mass() const {
  double sum = 0.0;
  for (const double m : mesh.mass) sum += m;
  return sum;
}

double ClothWorld::maxSpeed() const {
  double largest = 0.0;
  for (int n = 0; n < mesh.active(); ++n) largest = std::max(largest, velocities_[n].squaredNorm());
  return std::sqrt(largest);
}

}  // namespace haptic_cloth
