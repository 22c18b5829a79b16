#include "sim/cloth_world.h"

#include <algorithm>
#include <chrono>
#include <climits>
#include <utility>

#include "scene/scene_identity.h"

namespace haptic_cloth {
namespace {

// Speed below which friction is smoothed [m/s].
constexpr double kSlipSpeed = 3e-4;
// Width of the finest cells around a probe, beyond its radius [finest spacings].
constexpr double kFineReach = 2.0;

ContactSet::Options contactOptions(const Scene& scene) {
  ContactSet::Options options{scene.cloth.fabric.thickness, kSlipSpeed, scene.solver.time_step};
  if (scene.cloth.self_contact && scene.solver.cost == Cost::Condensed)  // the joint cost knows no pairs
    options.self = SelfContact::Options{CompressionLaw(scene.cloth.fabric), scene.cloth.self_friction};
  return options;
}

}  // namespace

ClothWorld::ClothWorld(const Scene& scene)
    : scene_(scene),
      cloth_(scene_),
      team_(scene_.solver.threads),
      contacts_(cloth_.grid(), scene_.obstacles, scene_.probes, contactOptions(scene_), team_),
      probes_(scene_),
      grasps_(probes_.count(), cloth_.grid()),
      adaptation_(scene_.adapt, cloth_.grid()),
      turns_(scene_.cloth.fabric, cloth_.grid(), scene_.gravity),
      sleep_(cloth_.grid(), scene_.solver.cost == Cost::Condensed ? scene_.solver.sleep_speed : 0.0),
      solver_(scene_, cloth_, contacts_, probes_, sleep_, team_),
      energy_(cloth_, solver_.objective()),
      force_error_(scene_),
      idle_(probes_.count()) {
  near_probes_.reserve(probes_.count());
  touches_.reserve(probes_.count());
  for (auto* flags : {&driven_, &stopped_}) flags->reserve(cloth_.grid().particles());
}

StepReport ClothWorld::step(int length) {
  if (!cloth_.pinsMove() && idle_.isIdle(probes_, contacts_)) return skipStep(length);
  StepReport report;
  team_.run(cloth_.mesh().active(), [&] { takeStep(length, report); });
  return report;
}

/// One step: move obstacles, adapt the mesh, update grasps, find contacts and solve, accept or restore,
/// balance energy.
void ClothWorld::takeStep(int length, StepReport& report) {
  const double h = length * scene_.solver.time_step;
  solver_.startBudget();
  energy_.beginStep(solver_.objective());
  cloth_.beginStep(h, time() + h);
  probes_.beginStep(h);
  contacts_.advance(h, cloth_.nodes());
  adapt(report);
  grasps_.update(probes_, cloth_.mesh(), cloth_.state());
  report.minimizer = solver_.solve(grasps_.nodes());  // finds the contacts, too
  energy_.noteStart(solver_.start(), solidsMove());
  report.failed = hasFailed(report.minimizer);
  if (report.failed) {
    restore();
  } else {
    accept(report);
  }
  reportPairs(report);
  energy_.update(scene_, solver_.objective(), contacts_, probes_);
  ++steps_;
  ticks_ += length;
  report.time = time();
  report.active_particles = cloth_.mesh().active();
  report.awake_particles = solver_.objective().awake().count();
  const long adapts = static_cast<long>(scene_.adapt.minimum_age) + scene_.adapt.interval;
  idle_.note(report, probes_, scene_.solver.sleep_speed, static_cast<int>(std::min(adapts, INT_MAX / 2L)));
}

/// Changes the mesh, if it is time for a decision and the cloth asks for it.
void ClothWorld::adapt(StepReport& report) {
  const auto start = std::chrono::steady_clock::now();
  if (planMesh()) {
    energy_.noteMeshChange(cloth_.changeMesh(adaptation_, ticks_));
    solver_.resize();
    report.refined = static_cast<int>(adaptation_.split().size());
    report.coarsened = static_cast<int>(adaptation_.merged().size());
    for (const Cell& cell : adaptation_.merged()) sleep_.disturb(cloth_.grid(), cell);
    for (const Cell& cell : adaptation_.split()) sleep_.disturb(cloth_.grid(), cell);
  } else {
    cloth_.updateNormals();
  }
  report.adapt_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Plans mesh changes from the end of the last step. @return whether there are any
bool ClothWorld::planMesh() {
  if (!adaptation_.startDecision(ticks_) || !adaptation_.changesMesh()) return false;
  const double spacing = cloth_.grid().longestSpacing(), reach = kFineReach * spacing;
  near_probes_.clear();
  for (int k = 0; k < probes_.count(); ++k) {
    const ProbeStep& probe = probes_.steps()[k];
    const double ahead = std::min((probe.device - probe.proxy).norm(), reach),
                 size = scene_.probes[k].extent();
    const double finest = size + reach + ahead,
                 near = probes_.reports()[k].contact ? scene_.adapt.near_reach * spacing : 0.0;
    if (probe.present) near_probes_.push_back({probe.proxy, finest, finest + near});
  }
  const TurnEstimate::View view = turnView();
  turns_.begin(view, std::min(scene_.adapt.refine_above, scene_.adapt.coarsen_below));
  bool asked = false;  // most decisions change nothing
  return adaptation_.plan(
      {ticks_, cloth_.nodes(), near_probes_, cloth_.leaves(), cloth_.mesh(), cloth_.state(),
       [&](const Cell& cell, int parts, double enough) { return turns_.turn(view, cell, parts, enough); },
       [&](const Cell& cell, int parts) { return turns_.carries(view, cell, parts, scene_.adapt.near_load); },
       [&](const Cell& cell, int parts, double moved) {
         if (parts == 2 && contacts_.maySink(cloth_.mesh(), cloth_.nodes(), cell, moved)) return false;
         if (!std::exchange(asked, true)) contacts_.beginChange(cloth_.mesh(), cloth_.nodes());
         return contacts_.hasRoom(cloth_.mesh(), cloth_.nodes(), cell, moved);
       }});
}

TurnEstimate::View ClothWorld::turnView() {
  touches_.clear();
  for (int k = 0; k < probes_.count(); ++k) {
    const ProbeReport& probe = probes_.reports()[k];
    if (probe.contact) touches_.push_back({probe.proxy, scene_.probes[k].radius, probe.force.norm()});
  }
  // A step longer than the interval decides each time.
  const double look_time =
      std::max(scene_.adapt.interval * scene_.solver.time_step, cloth_.integrator().stepLength());
  // Loads are compared for the default threshold. One that allows cells twice as long allows four
  // times the load on a cell.
  const double usual = AdaptOptions().refine_above;
  return {cloth_.mesh(),
          cloth_.internal(),
          contacts_,
          cloth_.nodes(),
          cloth_.velocities(),
          cloth_.weight(),
          look_time,
          touches_,
          usual * usual / scene_.adapt.refine_above};
}

/// Tells whether an obstacle moves in this step, or a probe turns whose turn is not solved for.
bool ClothWorld::solidsMove() const {
  for (int k = 0; k < contacts_.obstacles(); ++k) {
    if (contacts_.obstacleSpeed(k) > 0.0) return true;
  }
  for (int k = 0; k < probes_.count(); ++k) {
    if (probes_.turnsAsPrescribed(k)) return true;
  }
  return false;
}

/// Tells whether a probe touches or holds the cloth at the end of the solve.
bool ClothWorld::feelsCloth() const {
  for (int k = 0; k < probes_.count(); ++k) {
    if (probes_.isPresent(k) && (contacts_.probeTouched(k) || grasps_.holds(k))) return true;
  }
  return false;
}

/// Takes the solution as the state at the end of the step.
void ClothWorld::accept(StepReport& report) {
  const ClothObjective& solved = solver_.objective();
  const double kinetic_before = cloth_.kineticEnergy(), gravity_work = cloth_.gravityWork(solved.nodes());
  const double pinned_before = cloth_.pinnedKineticEnergy();
  const Vec3 momentum_before = cloth_.pinnedMomentum();
  // Ejected cloth is stopped after each step, and a belt may not carry cloth at once, but neither rests.
  markDriven();
  markStopped();
  contacts_.rememberFriction(cloth_.mesh(), cloth_.internal().nodeNormals());
  cloth_.move(solved, report.minimizer.motion_made);
  if (cloth_.pinsMove()) cloth_.advancePins(solver_.pinsMade());
  const double h = solved.timeStep(), pinned = cloth_.pinnedKineticEnergy();
  energy_.notePinWork(solved.pinWork() + pinned - pinned_before, 2.0 * h * scene_.air_damping * pinned);
  const Vec3 momentum = cloth_.pinnedMomentum();
  const Vec3 pinned_force = (momentum - momentum_before) / h + scene_.air_damping * momentum;
  sleep_.update(cloth_.mesh(), cloth_.velocities(), solved.awake().flags(), driven_);
  cloth_.stop(stopped_);
  report.velocity_scale = energy_.guard(kinetic_before, gravity_work, solved,
                                        report.minimizer.why == Termination::Converged, cloth_);
  cloth_.commit(team_);
  force_error_.noteCloth(cloth_, feelsCloth(), adaptation_.decidesAt(ticks_));
  probes_.accept(solved, contacts_, cloth_.mesh(), grasps_, force_error_);
  grasps_.noteTouched(probes_, contacts_, cloth_.mesh());
  support_force_ = contacts_.obstacleForce() + solved.pinForce() + pinned_force;
  report.max_penetration = contacts_.deepest();
}

void ClothWorld::reportPairs(StepReport& report) {
  if (!contacts_.meetsItself()) return;
  report.self_contacts = contacts_.self()->touching();
  report.min_self_gap = contacts_.smallestSelfGap(cloth_.nodes());
}

/// Marks the nodes that end the step at rest: obstacles eject, not throw them, or they sleep.
void ClothWorld::markStopped() {
  stopped_.assign(cloth_.mesh().nodes(), 0);
  contacts_.markEjected(stopped_);
  const std::vector<char>& awake = solver_.objective().awake().flags();
  for (int n = 0; n < cloth_.mesh().free; ++n) stopped_[n] |= awake[n] == 0;
}

/// Marks the nodes that obstacles eject, and those that moving obstacles touch.
void ClothWorld::markDriven() {
  const ActiveMesh& mesh = cloth_.mesh();
  driven_.assign(mesh.nodes(), 0);
  contacts_.markEjected(driven_);
  contacts_.markCarried(driven_);
  mesh.markMasters(driven_);
}

/// Returns to the start of the step, at rest: the last state known to be good.
void ClothWorld::restore() {
  cloth_.stop();
  solver_.restore();
  probes_.restore();
}

/// Makes a step that changes nothing but the time.
StepReport ClothWorld::skipStep(int length) {
  StepReport report = idle_.skipped();
  energy_.beginStep(solver_.objective());
  adaptation_.startDecision(ticks_);  // one for cloth that rests would change nothing
  ++steps_;
  ticks_ += length;
  report.time = time();
  report.active_particles = cloth_.mesh().active();
  return report;
}

void ClothWorld::setDevice(int k, const DeviceState& device) {
  DeviceState next = device;
  if (probes_.jumps(k, device, scene_.solver.time_step)) {
    removeDevice(k);
    next.velocity = Vec3::Zero();
  }
  probes_.setDevice(k, next);
}

void ClothWorld::removeDevice(int k) {
  probes_.remove(k);
  force_error_.forget(k);
  setGrasp(k, false);
  idle_.forget();  // a probe that returns at once to the same place is a new one
}

void ClothWorld::setGrasp(int k, bool closed) {
  if (closed != probes_.isClosed(k)) idle_.forget();  // what it held may fall
  probes_.setClosed(k, closed);
  if (!closed) grasps_.release(k);
}

void ClothWorld::setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping) {
  const bool sleeps = solver.cost == Cost::Condensed;
  if (solver.sleep_speed != scene_.solver.sleep_speed && sleeps) sleep_.setSpeed(solver.sleep_speed);
  scene_.solver = solver;
  scene_.air_damping = air_damping;
  cloth_.setAirDamping(air_damping);
  solver_.setOptions(solver.minimizer);
  setAdaptOptions(adapt);
}

void ClothWorld::setAdaptOptions(const AdaptOptions& options) {
  scene_.adapt = options;
  adaptation_.setOptions(options);
  idle_.forget();
}

void ClothWorld::setCoupling(int k, double stiffness, double damping) {
  ProbeOptions& probe = scene_.probes[k];
  probe.coupling_stiffness = stiffness;
  probe.coupling_damping = damping;
  solver_.setCoupling(k, stiffness, damping);
  idle_.forget();
}

void ClothWorld::serialize(Archive& archive) {
  serializeIdentity(archive, scene_);
  archive.within("steps", steps_, 0, LONG_MAX / 2);
  archive.within("ticks", ticks_, 0, LONG_MAX / 2);
  cloth_.serialize(archive);
  if (archive.loads()) solver_.resize();
  adaptation_.serialize(archive, ticks_);
  turns_.serialize(archive);
  archive("rest", sleep_);
  archive("contacts", contacts_);
  probes_.serialize(archive);
  force_error_.serialize(archive);
  grasps_.serialize(archive);
  idle_.serialize(archive);
  archive("objective", solver_.objective());
  energy_.serialize(archive);
  solver_.serializeCost(archive);
  archive("support_force", support_force_);
}

}  // namespace haptic_cloth
