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

/// Work of two solves of one step; the state is the last one's.
MinimizerReport sum(const MinimizerReport& a, MinimizerReport b) {
  b.iterations += a.iterations;
  b.evaluations += a.evaluations;
  b.restarts += a.restarts;
  b.seconds += a.seconds;
  return b;
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
      minimizer_(s.solver.minimizer) {
  if (internal.hasMemory()) history_.emplace(grid);
  nodes_.reserve(grid.particles());
  reach_.reserve(grid.particles());
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
}

StepReport ClothWorld::step() {
  StepReport report;
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
  return report;
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

/// Contacts are sought as far as each node is expected to move. Where one moved farther, something may have
/// been missed: the step is solved again with a reach that covers it.
void ClothWorld::solve(StepReport& report) {
  constexpr int kAttempts = 3;
  const double h = scene.solver.time_step;
  reach_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    reach_[n] =
        2.0 * h * (velocities_[n].norm() + h * scene.gravity.norm()) + 0.1 * std::min(grid.dx, grid.dy);
  }
  double proxy_reach = (probe_step_.device - probe_step_.proxy).norm() + 2.0 * h * probe.velocity.norm();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    findContacts(proxy_reach);
    const MinimizerReport last = minimise();
    report.minimizer = attempt == 0 ? last : sum(report.minimizer, last);
    const double proxy_moved = (objective.proxy() - probe_step_.proxy).norm();
    const bool proxy_covered = !probe_step_.present || !(proxy_moved > proxy_reach);
    if ((covered() && proxy_covered) || last.why == Termination::TimeBudget) return;
    proxy_reach = std::max(proxy_reach, 2.0 * proxy_moved);
  }
}

void ClothWorld::findContacts(double proxy_reach) {
  if (probe_step_.present && !probe_entered_)
    probe_entered_ = contacts.isClear(mesh, nodes_, probe_step_.proxy);
  const bool touches = probe_step_.present && probe_entered_;
  contacts.collect(mesh, nodes_, reach_, touches ? &probe_step_.proxy : nullptr, proxy_reach);
}

/// Whether no node moved farther in the step just solved than contacts were sought; else widens the reach of
/// all to twice what they moved.
bool ClothWorld::covered() {
  bool all = true;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const double moved = (objective.nodes()[n] - nodes_[n]).norm();
    all = all && !(moved > reach_[n]);
    reach_[n] = std::max(reach_[n], 2.0 * moved);
  }
  return all;
}

MinimizerReport ClothWorld::minimise() {
  objective.begin(nodes_, velocities_, probe_step_);
  const double start = chooseStart();
  if (joint_) return minimiseJoint();
  const MinimizerReport report = minimizer_.minimize(objective, x_, start, gradient_, team);
  cost.motion = objective.motionCost();
  return report;
}

/// Positions as the joint cost has them; forces and energies then are those of the laws there, as ever.
MinimizerReport ClothWorld::minimiseJoint() {
  joint_->begin(start_, x_, joint_x_);
  const MinimizerReport report = minimizer_.minimize(*joint_, joint_x_, team);
  cost = joint_->costs();
  x_.head(objective.size()) = joint_x_.head(objective.size());
  objective.evaluate(x_, gradient_);
  return report;
}

/// Where the solve starts: the lowest point of Φ's second-order model at rest along two ways, inertial motion
/// and what gravity adds to it, or rest itself where Φ is lower. So Φ never ends above that at rest, and
/// motion without new forces, free fall among it, is exact at any tolerance.
/// @return Φ there; gradient_ is its gradient
double ClothWorld::chooseStart() {
  const int size = objective.size();
  objective.pack(nodes_, probe_step_.proxy, start_);
  const double at_rest = objective.evaluate(start_, gradient_);
  Sums parts;
  energy_before_ = objective.internalEnergy(parts) + objective.couplingEnergy() + objective.lossPotential() -
                   std::max(0.0, created_);
  const std::array<double, 2> steps = stepsAlongWays();
  motion_.head(size) = steps[0] * ways_[0].head(size) + steps[1] * ways_[1].head(size);
  const double reach = std::min(1.0, objective.along(motion_).max_step);
  x_.head(size) = start_.head(size) + reach * motion_.head(size);
  const double moving = objective.evaluate(x_, gradient_);
  if (moving <= at_rest) return moving;
  x_.head(size) = start_.head(size);
  return objective.evaluate(x_, gradient_);
}

/// Minimum of Φ's model on the plane of the two ways; on their sum where they are one line.
std::array<double, 2> ClothWorld::stepsAlongWays() {
  const double h = scene.solver.time_step, share = h / (1.0 + scene.air_damping * h);
  const int size = objective.size();
  for (int c = 0; c < 3; ++c) {
    ways_[0].segment(c * mesh.free, mesh.free) =
        share * Eigen::Map<const Vector>(velocities_.coordinate(c).data(), mesh.free);
    ways_[1].segment(c * mesh.free, mesh.free).setConstant(share * h * scene.gravity[c]);
  }
  if (probe_step_.present) {
    ways_[0].segment<3>(3 * mesh.free) = h * probe.velocity;
    ways_[1].segment<3>(3 * mesh.free).setZero();
  }
  motion_.head(size) = ways_[0].head(size) + ways_[1].head(size);
  const double a = objective.along(ways_[0]).curvature, b = objective.along(ways_[1]).curvature,
               both = objective.along(motion_).curvature, mixed = 0.5 * (both - a - b);
  const double p = -gradient_.head(size).dot(ways_[0].head(size)),
               q = -gradient_.head(size).dot(ways_[1].head(size));
  const double determinant = a * b - mixed * mixed;
  if (determinant > 1e-9 * a * b) {
    return {(b * p - mixed * q) / determinant, (a * q - mixed * p) / determinant};
  }
  const double sum = both > 0.0 ? (p + q) / both : 0.0;
  return {sum, sum};
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

/// Passivity: what moves may not hold more kinetic energy than is left [J] of what the step began with, the
/// work of its inputs included. @return scale of the velocities, 1 where nothing was to do
double ClothWorld::guardEnergy(double left) {
  const double kinetic = kineticEnergy();
  const double allowed = std::max(0.0, left);
  if (kinetic <= allowed || kinetic == 0.0) return 1.0;
  const double scale = std::sqrt(allowed / kinetic);
  for (int n = 0; n < mesh.nodes(); ++n) velocities_.set(n, scale * velocities_[n]);
  return scale;
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

/// What the device does: it works on spring and damper of the coupling; taking it away takes the spring's
/// energy with it. What is missing in the balance at the end of a step was dissipated, in a failed step too.
void ClothWorld::account() {
  if (probe_step_.present) {
    const ProbeStep& made = objective.probeStep();
    const double spring =
        0.5 * scene.probe.coupling_stiffness * (made.device - made.proxy).squaredNorm() - coupling_;
    const double damper = scene.probe.coupling_damping * scene.solver.time_step *
                          (made.device_velocity - probe.velocity).dot(made.device_velocity);
    supplied_ += spring + damper;
  } else {
    supplied_ -= coupling_;
  }
  coupling_ = objective.couplingEnergy();
}

double ClothWorld::kineticEnergy() const {
  double kinetic = 0.0;
  for (int n = 0; n < mesh.active(); ++n) kinetic += 0.5 * mesh.mass[n] * velocities_[n].squaredNorm();
  return kinetic;
}

/// Kinetic energy and that of gravity.
EnergyReport ClothWorld::measureMotion() const {
  EnergyReport e;
  e.kinetic = kineticEnergy();
  for (int n = 0; n < mesh.active(); ++n) e.gravity -= mesh.mass[n] * scene.gravity.dot(nodes_[n]);
  return e;
}

/// Kinetic energy, that of gravity and what the fabric stores [J].
double ClothWorld::cohesion() const {
  const EnergyReport motion = measureMotion();
  const InternalEnergy::Energy stored = internal.stored(nodes_);
  return motion.kinetic + motion.gravity + stored.stretch + stored.bend + stored.shear;
}

EnergyReport ClothWorld::energy() const {
  EnergyReport e = measureMotion();
  Sums parts;
  objective.internalEnergy(parts);
  const InternalEnergy::Energy stored =
      history_ ? internal.stored(nodes_) : InternalEnergy::Energy{parts[0], parts[1], parts[2]};
  e.stretch = stored.stretch;
  e.bend = stored.bend;
  e.shear = stored.shear;
  e.contact = parts[3];
  e.coupling = objective.couplingEnergy();
  e.dissipated = supplied_ - e.total();
  return e;
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
