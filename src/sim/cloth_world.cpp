#include "sim/cloth_world.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace haptic_cloth {
namespace {

// Speed below which friction is smoothed [m/s]; held cloth creeps at most this fast.
constexpr double kSlipSpeed = 3e-4;
// Width of the finest cells around a probe, beyond its radius [finest spacings].
constexpr double kFineReach = 2.0;

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
  return {scene.cloth.fabric.thickness, kSlipSpeed, scene.solver.time_step};
}

}  // namespace

ClothWorld::ClothWorld(const Scene& s)
    : scene(s),
      grid(makeGrid(s)),
      leaves(grid, s.cloth.pins, Adaptation::startLevel(s.adapt)),
      mesh(leaves, s.cloth.fabric.areal_density),
      state(flatState(s, grid)),
      internal(s.cloth.fabric, mesh),
      team(s.solver.threads),
      contacts(grid, s.obstacles, s.probes, contactOptions(s), team),
      objective(s, mesh, internal, contacts, team),
      probes(s.probes.size()),
      adaptation_(s.adapt, grid),
      load_(s.cloth.fabric, grid, s.gravity),
      sleep_(grid, s.solver.cost == Cost::Condensed ? s.solver.sleep_speed : 0.0),
      minimizer_(s.solver.minimizer),
      probe_steps_(s.probes.size()),
      memories_(s.probes.size()),
      touched_by_(s.probes.size()),
      proxy_reach_(s.probes.size()) {
  idle_probes_.reserve(s.probes.size());
  fine_.reserve(s.probes.size());
  touches_.reserve(s.probes.size());
  touching_.reserve(s.probes.size());
  held_.reserve(grid.particles());
  for (auto& list : touched_by_) list.reserve(grid.particles());
  held_nodes_.reserve(grid.particles());
  touched_.reserve(4 * grid.particles());
  if (internal.hasMemory()) history_.emplace(grid);
  nodes_.reserve(grid.particles());
  reach_.reserve(grid.particles());
  forces_.reserve(grid.particles());
  let_out_nodes_.reserve(grid.particles());
  weight_.reserve(grid.particles());
  velocities_.reserve(grid.particles());
  // Eigen does not initialise these vectors, so pages that no mesh needs take no memory.
  for (Vector* v : {&x_, &start_, &ways_[0], &ways_[1], &motion_, &gradient_})
    v->resize(objective.capacity());
  if (s.solver.cost == Cost::Joint) {
    joint_.emplace(objective, mesh, internal, contacts, team);
    joint_x_.resize(joint_->capacity());
  }
  const int unknowns = joint_ ? joint_->capacity() : objective.capacity();
  minimizer_.reserve(unknowns);
  team.reserve(std::max(unknowns, NodeGather::capacity(mesh) + contacts.capacity()));
  gatherNodes();
  weight_.assign(mesh.nodes(), 0.0);  // zero as in free fall
  internal.setNormals(nodes_);
  reach_.assign(mesh.nodes(), 0.0);
  findContacts(proxy_reach_);  // cloth that starts in contact has contact energy
  objective.begin(nodes_, velocities_, probe_steps_);
  objective.pack(nodes_, start_);
  objective.evaluate(start_, gradient_);
  initial_ = supplied_ = energy().total();
}

void ClothWorld::setDevice(int k, const DeviceState& device) {
  const bool finite = device.position.allFinite() && device.velocity.allFinite() &&
                      device.orientation.coeffs().allFinite() && device.orientation.norm() > 0.0;
  if (!finite) return;
  ProbeStep& step = probe_steps_[k];
  const double elapsed = std::max(device.elapsed, scene.solver.time_step);
  const bool jumped = step.present && isJump((device.position - step.device).norm(), elapsed);
  if (jumped) removeDevice(k);
  memories_[k].after = device.orientation.normalized();
  if (!step.present) {
    step.proxy = device.position;
    probes[k].proxy = device.position;
    probes[k].velocity = Vec3::Zero();
    memories_[k].entered = false;
    memories_[k].before = memories_[k].after;
  }
  step.present = true;
  step.device = device.position;
  step.device_velocity = jumped ? Vec3(Vec3::Zero()) : device.velocity;
  probes[k].present = true;
  probes[k].device = device.position;
}

void ClothWorld::removeDevice(int k) {
  probe_steps_[k] = ProbeStep();
  probes[k] = ProbeReport();
  setGrasp(k, false);
  forgetIdle();  // a probe that returns at once to the same place is a new one
}

void ClothWorld::setGrasp(int k, bool closed) {
  memories_[k].closed = closed;
  const auto let_go = [&](const HeldParticle& held) { return held.probe == k; };
  if (closed) return;
  held_.erase(std::remove_if(held_.begin(), held_.end(), let_go), held_.end());
  touched_by_[k].clear();  // the probe may close again elsewhere
}

void ClothWorld::setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping) {
  if (solver.sleep_speed != scene.solver.sleep_speed && !joint_) sleep_.setSpeed(solver.sleep_speed);
  scene.solver = solver;
  scene.adapt = adapt;
  scene.air_damping = air_damping;
  minimizer_.setOptions(solver.minimizer);
  objective.setAirDamping(air_damping);
  setAdaptOptions(adapt);
}

void ClothWorld::setCoupling(int k, double stiffness, double damping) {
  ProbeOptions& probe = scene.probes[k];
  if (probe.coupling_stiffness == stiffness && probe.coupling_damping == damping) return;
  probe.coupling_stiffness = stiffness;
  probe.coupling_damping = damping;
  objective.setCoupling(k, stiffness, damping);
  forgetIdle();
}

StepReport ClothWorld::step() {
  if (isIdle()) return idle();
  StepReport report;
  team.run(mesh.active(), [&] { takeStep(report); });
  return report;
}

void ClothWorld::takeStep(StepReport& report) {
  minimizer_.startBudget();
  contact_before_ = objective.contactEnergy();
  contacts.advance();
  const auto start = std::chrono::steady_clock::now();
  adapt(report);
  report.adapt_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  takeHold();
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
  report.awake_particles = objective.awake().count();
  noteIdle(report);
}

/// Tells whether a step would change nothing: all nodes sleep, and the inputs are those of the last
/// solved step.
bool ClothWorld::isIdle() const {
  if (!idle_ || contacts.obstaclesMove() || !devicesStay()) return false;
  for (std::size_t k = 0; k < probe_steps_.size(); ++k) {
    const ProbeMemory& memory = memories_[k];
    const bool moves = memory.turns() || !probe_steps_[k].device_velocity.isZero(0.0);
    if (probe_steps_[k].present && (memory.closed || moves)) return false;
  }
  return true;
}

/// Tells whether an obstacle moves or a probe turns in this step.
bool ClothWorld::solidsMove() const {
  for (int k = 0; k < contacts.obstacles(); ++k) {
    if (contacts.obstacleSpeed(k) > 0.0) return true;
  }
  for (std::size_t k = 0; k < probe_steps_.size(); ++k) {
    if (probe_steps_[k].present && memories_[k].turns()) return true;
  }
  return false;
}

/// Tells whether the same probes are present as in the last solved step, with their devices in the
/// same positions.
bool ClothWorld::devicesStay() const {
  return std::equal(probe_steps_.begin(), probe_steps_.end(), idle_probes_.begin(), idle_probes_.end(),
                    [](const ProbeStep& now, const ProbeStep& then) {
                      return now.present == then.present && now.device == then.device;
                    });
}

StepReport ClothWorld::idle() {
  StepReport report;
  report.minimizer.residual = idle_residual_;
  ++steps;
  report.time = time();
  report.active_particles = mesh.active();
  return report;
}

/// Decides whether the next steps may be skipped if no input changes.
void ClothWorld::noteIdle(const StepReport& report) {
  const bool proxies_rest = std::all_of(probes.begin(), probes.end(), [this](const ProbeReport& probe) {
    return !probe.present || probe.velocity.norm() < scene.solver.sleep_speed;
  });
  const bool changed = !devicesStay() || report.refined > 0 || report.coarsened > 0 || report.failed;
  quiet_ = objective.awake().count() == 0 && proxies_rest && !changed ? quiet_ + 1 : 0;
  idle_ = quiet_ >= SleepTracker::kSteps;  // the mesh has had time to adapt
  idle_probes_ = probe_steps_;
  idle_residual_ = report.minimizer.residual;
}

/// Reads node values from the state of the finest grid.
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

/// Updates everything that depends on the mesh, after a change.
void ClothWorld::takeMesh() {
  internal.resize();
  objective.resize();
  gatherNodes();
  internal.setNormals(nodes_);
}

/// Plans mesh changes from the end of the last step. @return whether there are any
bool ClothWorld::planMesh() {
  const double reach = kFineReach * std::max(grid.dx, grid.dy);
  fine_.clear();
  for (std::size_t k = 0; k < probe_steps_.size(); ++k) {
    const ProbeStep& probe = probe_steps_[k];
    const double ahead = std::min((probe.device - probe.proxy).norm(), reach),
                 size = scene.probes[k].radius + 0.5 * scene.probes[k].length;
    if (probe.present) fine_.push_back({probe.proxy, size + reach + ahead});
  }
  if (!adaptation_.looks(steps)) return false;
  const LoadEstimate::View view = loadView();
  load_.begin(view, std::min(scene.adapt.refine_above, scene.adapt.coarsen_below));
  return adaptation_.plan(steps, nodes_, internal, fine_, leaves, mesh, state,
                          [&](const Cell& cell, int parts) { return load_.turn(view, cell, parts); });
}

LoadEstimate::View ClothWorld::loadView() {
  touches_.clear();
  for (std::size_t k = 0; k < probes.size(); ++k) {
    if (!probes[k].contact) continue;
    touches_.push_back({probes[k].proxy, scene.probes[k].radius, probes[k].force.norm()});
  }
  const double look_time = scene.adapt.interval * scene.solver.time_step;
  // The share of the force is that of the default threshold. One that allows cells twice as long
  // allows four times the load on a cell.
  const double usual = AdaptOptions().refine_above;
  return {mesh,      internal,    contacts,
          nodes_,    velocities_, weight_,
          look_time, touches_,    usual * usual / scene.adapt.refine_above};
}

void ClothWorld::adapt(StepReport& report) {
  created_ = 0.0;
  if (!planMesh()) {
    internal.setNormals(nodes_);
    return;
  }
  const double before = measureMotion().total();
  internal.beginChange(nodes_);
  if (history_) internal.remember(nodes_, *history_);
  adaptation_.apply(steps, leaves, mesh, state);
  report.refined = static_cast<int>(adaptation_.split().size());
  report.coarsened = static_cast<int>(adaptation_.merged().size());
  for (const Cell& cell : adaptation_.merged()) sleep_.disturb(grid, cell);
  for (const Cell& cell : adaptation_.split()) sleep_.disturb(grid, cell);
  takeMesh();
  internal.endChange(nodes_);
  if (history_) {
    for (const Cell& parent : adaptation_.merged()) history_->merge(parent);
    for (const Cell& parent : adaptation_.split()) history_->split(parent);
    internal.recall(nodes_, *history_);
  }
  created_ = measureMotion().total() - before + internal.madeByChange(nodes_);
}

/// Updates grasps. A closed probe that holds nothing grasps the cloth that it touched at the end of
/// the last step. Particles that left the mesh are not held in this step.
void ClothWorld::takeHold() {
  const auto free_node = [this](int particle) {
    return mesh.node[particle] >= 0 && mesh.node[particle] < mesh.free;
  };
  for (int k = 0; k < static_cast<int>(memories_.size()); ++k) {
    const auto own = [k](const HeldParticle& held) { return held.probe == k; };
    if (!memories_[k].closed || std::any_of(held_.begin(), held_.end(), own)) continue;
    for (const int particle : touched_by_[k]) {
      const auto same = [particle](const HeldParticle& held) { return held.particle == particle; };
      if (!free_node(particle) || std::any_of(held_.begin(), held_.end(), same)) continue;
      held_.push_back({particle, k, state.position[particle] - probe_steps_[k].proxy});
    }
  }
  held_nodes_.clear();
  for (const HeldParticle& held : held_) {
    if (free_node(held.particle)) held_nodes_.push_back({mesh.node[held.particle], held.probe, held.offset});
  }
}

void ClothWorld::accept(StepReport& report) {
  const Field& after = objective.nodes();
  const double kinetic_before = kineticEnergy();
  double gravity_work = 0.0;
  for (int n = 0; n < mesh.active(); ++n) {
    gravity_work += mesh.mass[n] * scene.gravity.dot(after[n] - nodes_[n]);
  }
  objective.integrator().updateVelocities(nodes_, after, velocities_);
  measureWeight();
  nodes_ = after;
  let_out_nodes_.assign(mesh.nodes(), 0);
  contacts.markLetOut(let_out_nodes_);
  for (auto g = mesh.ghosts.rbegin(); g != mesh.ghosts.rend(); ++g) {
    if (let_out_nodes_[g->node] != 0) let_out_nodes_[g->a] = let_out_nodes_[g->b] = 1;
  }
  sleep_.update(mesh, velocities_, objective.awake().flags(), let_out_nodes_);
  // Ejected cloth is stopped after each step, but does not count as resting.
  contacts.calm(velocities_);

  Sums parts;
  const double spent =
      objective.internalEnergy(parts) + objective.couplingEnergy() + objective.lossPotential();
  report.velocity_scale = guardEnergy(energy_before_ + kinetic_before + gravity_work - spent);
  for (int n = 0; n < mesh.nodes(); ++n) {
    state.position[mesh.particle[n]] = nodes_[n];
    state.velocity[mesh.particle[n]] = velocities_[n];
  }
  for (std::size_t k = 0; k < probes.size(); ++k) acceptProbe(static_cast<int>(k));
  if (history_) {
    team.forRange(internal.size(), [this](int begin, int end) { internal.commit(begin, end, nodes_); });
  }
  support_force = contacts.obstacleForce() + objective.pinForce();
  report.max_penetration = contacts.deepest();
}

/// Measures gravity minus the acceleration of the last solve, along the normal: zero in free fall.
void ClothWorld::measureWeight() {
  const Field& after = objective.nodes();
  weight_.resize(mesh.nodes());
  for (int n = 0; n < mesh.active(); ++n) {
    weight_[n] = -objective.motionGradient(n, after[n]).dot(internal.normal(n)) / mesh.mass[n];
  }
  for (const Ghost& g : mesh.ghosts) weight_[g.node] = 0.5 * (weight_[g.a] + weight_[g.b]);
}

void ClothWorld::acceptProbe(int k) {
  if (!probe_steps_[k].present) return;
  ProbeReport& probe = probes[k];
  probe.proxy = objective.proxy(k);
  probe.velocity = (probe.proxy - probe_steps_[k].proxy) / scene.solver.time_step;
  probe.force = objective.holdForce(k) - contacts.proxyGradient(k);
  probe.torque = objective.holdTorque(k) + contacts.proxyTorque(k, nodes_);
  probe.grasps = std::any_of(held_nodes_.begin(), held_nodes_.end(),
                             [k](const HeldNode& held) { return held.probe == k; });
  probe.contact = probe.grasps || contacts.probeTouched(k);
  probe_steps_[k].proxy = probe.proxy;
  memories_[k].before = memories_[k].after;
  if (!memories_[k].closed) return;
  touched_.clear();
  contacts.touchedNodes(k, touched_);
  for (int& n : touched_) n = mesh.particle[n];
  std::sort(touched_.begin(), touched_.end());
  touched_by_[k].assign(touched_.begin(), std::unique(touched_.begin(), touched_.end()));
}

/// Returns to the start of the step, at rest: the last state known to be good.
void ClothWorld::restore() {
  velocities_.fill(0.0);
  weight_.assign(mesh.nodes(), 0.0);
  for (int n = 0; n < mesh.nodes(); ++n) state.velocity[mesh.particle[n]] = Vec3::Zero();
  objective.pack(nodes_, start_);
  objective.evaluate(start_, gradient_);
  for (ProbeReport& probe : probes) {
    probe.velocity = Vec3::Zero();
    probe.force = probe.torque = Vec3::Zero();
    probe.contact = false;
  }
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
