#include "sim/step_solver.h"

#include <algorithm>
#include <cmath>

#include "contact/crossings.h"

namespace haptic_cloth {
namespace {

/// Report of two solves of one step: work is added, the state is that of the last solve.
MinimizerReport sum(const MinimizerReport& a, MinimizerReport b) {
  b.iterations += a.iterations;
  b.evaluations += a.evaluations;
  b.restarts += a.restarts;
  b.seconds += a.seconds;
  return b;
}

/// Tells whether a solve was stopped by a limit, with a usable state.
bool isCut(const MinimizerReport& report) {
  return report.why != Termination::Converged && report.why != Termination::NotFinite;
}

}  // namespace

StepSolver::StepSolver(const Scene& scene, Cloth& cloth, ContactSet& contacts, Probes& probes,
                       SleepTracker& sleep, Team& team)
    : scene_(scene),
      cloth_(cloth),
      contacts_(contacts),
      probes_(probes),
      sleep_(sleep),
      team_(team),
      objective_(scene, cloth.mesh(), cloth.integrator(), cloth.internal(), contacts, team),
      minimizer_(scene.solver.minimizer),
      reach_(scene, cloth, probes) {
  forces_.reserve(cloth.grid().particles());
  for (Field* field : {&pinned_, &end_}) field->reserve(cloth.grid().particles());
  touched_.reserve(cloth.grid().particles());
  // Eigen does not initialise these vectors, so pages that no mesh needs take no memory.
  for (Vector* v : {&x_, &start_, &directions_[0], &directions_[1], &motion_, &gradient_})
    v->resize(objective_.capacity());
  if (scene.solver.cost == Cost::Joint) {
    joint_.emplace(objective_, cloth.mesh(), cloth.internal(), contacts, team);
    joint_x_.resize(joint_->capacity());
  }
  const int unknowns = joint_ ? joint_->capacity() : objective_.capacity();
  minimizer_.reserve(unknowns);
  team.reserve(std::max(unknowns, NodeGather::capacity(cloth.mesh()) + contacts.capacity()));
  contacts.rebuild(cloth.mesh());
  findContacts();  // cloth that starts in contact has contact energy
  objective_.begin(cloth.nodes(), cloth.velocities(), probes.steps());
  evaluateStart();
}

void StepSolver::resize() {
  objective_.resize();
  contacts_.rebuild(cloth_.mesh());
}

MinimizerReport StepSolver::solve(const std::vector<HeldNode>& held) {
  constexpr int kAttempts = 4;
  MinimizerReport report;
  reach_.estimate();
  contacts_.forgetRough();
  bool apart = true;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    findContacts();
    if (cloth_.integrator().secondOrder()) foreseeTouches(held);
    beginSolve(held);
    const MinimizerReport last = joint_ ? minimizeJoint() : minimizeCondensed();
    report = attempt == 0 ? last : sum(report, last);
    if (last.why == Termination::NotFinite) break;
    const bool covered = reach_.covers(objective_);
    apart = contacts_.unlistedStayApart(cloth_.mesh(), cloth_.nodes(), objective_.nodes(),
                                        !reach_.coversPairs(objective_));
    if (covered && apart) break;
  }
  if (report.why == Termination::NotFinite) return report;
  // The cloth might have passed through itself where it was not looked at.
  if (!apart || (!contacts_.pairsStayApart(cloth_.nodes(), objective_.nodes()) && crosses()))
    shortenMotion(report);
  return report;
}

/// Tells whether the solution passes through itself and the start of the step does not.
bool StepSolver::crosses() const {
  const auto crossed = [this](const Field& nodes) { return findCrossings(cloth_.mesh(), nodes).pairs > 0; };
  return crossed(objective_.nodes()) && !crossed(cloth_.nodes());
}

/// Leaves a part of the motion to the solution: on the straight way there no pair of layers can have met,
/// listed or not, and Φ is not above Φ(x⁰) with the pins where they are then. It may end after the time
/// budget.
void StepSolver::shortenMotion(MinimizerReport& report) {
  constexpr int kTrials = 10;
  const int size = objective_.size();
  report.why = Termination::OutOfReach;
  report.motion_made = 0.0;
  end_ = objective_.nodes();
  objective_.setPinned(cloth_.nodes());
  evaluateStart();
  double share = objective_.shareOfWay(end_, x_);
  motion_.head(size) = x_.head(size) - start_.head(size);
  pinned_ = cloth_.nodes();
  for (int trial = 0; trial < kTrials; ++trial, share *= 0.5) {
    for (int n = cloth_.mesh().free; n < cloth_.mesh().active(); ++n)
      pinned_.set(n, cloth_.nodes()[n] + share * (end_[n] - cloth_.nodes()[n]));
    objective_.setPinned(pinned_);
    const double start = cloth_.pinsMove() ? objective_.evaluate(start_, gradient_) : start_values_.potential;
    x_.head(size) = start_.head(size) + share * motion_.head(size);
    report.value_end = objective_.evaluate(x_, gradient_);
    if (!(report.value_end <= start)) continue;
    if (!contacts_.unlistedStayApart(cloth_.mesh(), cloth_.nodes(), objective_.nodes(), true)) continue;
    // What a probe holds goes on an arc.
    if (!contacts_.pairsStayApart(cloth_.nodes(), objective_.nodes())) continue;
    objective_.measureSleepers();
    report.residual = objective_.residual(gradient_);
    report.motion_made = share;
    cost_.motion = objective_.motionCost();
    for (double& made : pins_made_) made *= share;
    return;
  }
}

void StepSolver::findContacts() {
  const auto& touching = probes_.findTouching(cloth_.mesh(), cloth_.nodes(), reach_.proxies(), contacts_);
  const auto pairs = [this] {
    contacts_.collectPairs(cloth_.mesh(), cloth_.nodes(), cloth_.internal().nodeNormals(), reach_.pairs());
  };
  contacts_.collectProbes(cloth_.mesh(), cloth_.nodes(), reach_.nodes(), reach_.motion(), touching);
  team_.runBeside(pairs, [&] {
    contacts_.collectObstacles(cloth_.mesh(), cloth_.nodes(), reach_.nodes(), reach_.motion());
  });
}

/// Tells the cloth which nodes may touch something in the step, or are held.
void StepSolver::foreseeTouches(const std::vector<HeldNode>& held) {
  touched_.assign(cloth_.mesh().nodes(), 0);
  contacts_.markListed(touched_);
  for (const HeldNode& node : held) touched_[node.node] = 1;
  cloth_.mesh().markMasters(touched_);
  cloth_.expectJumps(touched_);
}

/// Evaluates Φ and its gradient with all nodes and proxies at x⁰. @return Φ
double StepSolver::evaluateStart() {
  objective_.pack(cloth_.nodes(), start_);
  return objective_.evaluate(start_, gradient_);
}

/// Starts a solve at x⁰, with all nodes awake.
void StepSolver::beginSolve(const std::vector<HeldNode>& held) {
  objective_.begin(cloth_.nodes(), cloth_.velocities(), probes_.steps(), held);
  start_values_.potential = evaluateStart();
  start_values_.energy = objective_.storedAndLost();
  start_values_.contact = objective_.contactEnergy();
  start_values_.layers = objective_.layerEnergy();
  start_values_.friction = objective_.frictionPotential();
  if (cloth_.pinsMove()) movePins();
  x_.head(objective_.size()) = start_.head(objective_.size());
}

/// Moves the pins to where they end in the step, or as near to it as nothing is crossed; the other
/// nodes follow in the solve. A pin that something stops does not hold back the others, unless only another
/// pin that moves is in its way.
void StepSolver::movePins() {
  pins_made_.assign(cloth_.pins(), 0.0);
  pins_go_.assign(cloth_.pins(), 1);
  bool more = true;
  while (more) {
    pinned_ = objective_.nodes();
    for (int k = 0; k < cloth_.pins(); ++k) {
      if (pins_go_[k]) cloth_.placePin(k, pinned_);
    }
    const double share = objective_.pinnedShare(pinned_);
    for (int k = 0; k < cloth_.pins(); ++k) {
      if (pins_go_[k]) pins_made_[k] += share * (1.0 - pins_made_[k]);
    }
    more = share < 1.0 && stopPins();
    objective_.movePinned(pinned_, share);
    start_values_.potential = objective_.evaluate(start_, gradient_);
  }
}

/// Stops the pins that could not reach their end if they moved alone. @return whether there are any, and
/// others go on
bool StepSolver::stopPins() {
  bool stopped = false;
  for (int k = 0; k < cloth_.pins(); ++k) {
    if (!pins_go_[k]) continue;
    end_ = objective_.nodes();
    cloth_.placePin(k, end_);
    pins_go_[k] = objective_.pinnedShare(end_) == 1.0;
    stopped = stopped || !pins_go_[k];
  }
  return stopped && std::any_of(pins_go_.begin(), pins_go_.end(), [](char goes) { return goes != 0; });
}

/// Minimises over the awake nodes. After each solve everything is evaluated, and sleeping nodes
/// that were pushed wake. The last solve, if it is needed, covers all nodes, so a step reported as
/// converged has converged as a whole.
MinimizerReport StepSolver::minimizeCondensed() {
  constexpr int kSolves = 4;
  const double tolerance = scene_.solver.minimizer.tolerance;
  AwakeSet& awake = objective_.awake();
  MinimizerReport report;
  report.residual = objective_.residual(gradient_);
  sleep_.begin(cloth_.mesh());
  if (sleep_.possible() && objective_.held().empty()) awake.sleepAll();
  for (int solve = 0; solve < kSolves; ++solve) {
    const bool more = wakeDisturbed();
    const bool first = solve == 0 && (awake.all() || objective_.size() > 3 * cloth_.mesh().free);
    const bool left = solve > 0 && report.why == Termination::Converged && report.residual > tolerance;
    if (!more && !first && !left) break;
    if (solve == kSolves - 1) awake.wakeAll();
    const double start = solve == 0 ? chooseInitialGuess() : objective_.evaluate(x_, gradient_);
    const int least = solve == 0 && (moves() || markCarried()) ? 1 : 0;
    report = sum(report, minimizer_.minimize(objective_, x_, start, gradient_, team_, least));
    if (balanceAfter(report, report.value_end)) report.residual = objective_.residual(gradient_);
    const bool ended = report.why == Termination::NotFinite || report.why == Termination::TimeBudget;
    if (awake.all()) break;
    awake.coverAll();  // also after an early end: energies and forces are summed over all
    objective_.evaluate(x_, gradient_);
    objective_.measureSleepers();
    report.residual = objective_.residual(gradient_);
    if (ended) break;
  }
  cost_.motion = objective_.motionCost();
  return report;
}

/// Tells whether the awake cloth moves so fast that a step should not keep to its initial guess: the guess
/// knows no elastic force on a single node, so a gentle swing, whose forces are within the tolerance, would
/// fade.
bool StepSolver::moves() const {
  double mass = 0.0, twice_kinetic = 0.0;
  for (int n = 0; n < cloth_.mesh().free; ++n) {
    if (!objective_.awake().contains(n)) continue;
    mass += cloth_.mesh().mass[n];
    twice_kinetic += cloth_.mesh().mass[n] * cloth_.velocities()[n].squaredNorm();
  }
  return twice_kinetic > Cloth::kSlow * Cloth::kSlow * mass;
}

/// Marks the nodes that moving obstacles touch. @return whether there are any
bool StepSolver::markCarried() {
  touched_.assign(cloth_.mesh().nodes(), 0);
  const bool any = contacts_.markCarried(touched_);
  cloth_.mesh().markMasters(touched_);
  return any;
}

/// Wakes nodes that may not sleep at the last evaluated point. @return whether there were any
bool StepSolver::wakeDisturbed() {
  if (objective_.awake().all()) return false;
  const double unit = objective_.accelerationUnit(), tolerance = scene_.solver.minimizer.tolerance * unit;
  objective_.forcesAtRest(forces_);
  markCarried();
  sleep_.updateCandidates(cloth_.mesh(), forces_, objective_.gradient(), tolerance, unit,
                          objective_.awake().flags(), touched_);
  const bool more = objective_.awake().wake(sleep_);
  objective_.measureSleepers();
  return more;
}

/// Minimises the joint cost; forces and energies are then those of the laws at its positions. The
/// joint cost may fall while Φ rises. If the solve was cut short above Φ(x⁰), which the condensed
/// cost never is, the step stays at the initial guess. Otherwise a step could create any amount of
/// energy.
MinimizerReport StepSolver::minimizeJoint() {
  chooseInitialGuess();
  const int size = objective_.size();
  joint_->begin(start_, x_, joint_x_);
  MinimizerReport report = minimizer_.minimize(*joint_, joint_x_, team_);
  cost_ = joint_->costs();
  motion_.head(size) = x_.head(size);
  x_.head(size) = joint_x_.head(size);
  double end = objective_.evaluate(x_, gradient_);
  if (isCut(report) && !(end <= start_values_.potential)) {
    x_.head(size) = motion_.head(size);
    end = objective_.evaluate(x_, gradient_);
    report.why = Termination::LineSearchFailed;
  }
  balanceAfter(report, end);
  return report;
}

/// Balances the net force after a solve, but on pinned cloth that has converged: there it is as small as any
/// other part of the residual. What has converged stays so.
/// @param value Φ at x_, which it may lower  @return as balanceNetForce()
bool StepSolver::balanceAfter(const MinimizerReport& report, double& value) {
  if (isCut(report)) return balanceNetForce(value);
  if (report.why != Termination::Converged || !objective_.allFree()) return false;
  return balanceNetForce(value, 3, scene_.solver.minimizer.tolerance);
}

/// Moves the awake cloth as a whole to the minimum of Φ's quadratic model: along the net force on it, or, if
/// it is free, in any direction. So its centre of mass obeys Newton's law at a guess, and however a solve
/// ended. A net force may be far below the tolerance and still be all that lets cloth slide.
/// @pre the last evaluation was at x_  @param value Φ at x_, which it may lower
/// @param trials points that it may try  @param most_residual that it may leave [-]
/// @return whether Φ was evaluated; then gradient_ is that at x_
bool StepSolver::balanceNetForce(double& value, int trials, double most_residual) {
  constexpr double kLeast = 0.01;      // of the tolerance: not worth an evaluation
  constexpr double kRounding = 1e-10;  // relative to Φ, as in the line search of the minimizer
  const int size = objective_.size(), free = cloth_.mesh().free;
  const double least =
      kLeast * scene_.solver.minimizer.tolerance * cloth_.mass() * objective_.accelerationUnit();
  const auto setMotion = [&](const Vec3& moved) {
    motion_.head(size).setZero();
    for (int c = 0; c < 3; ++c) motion_.segment(c * free, free).setConstant(moved[c]);
    objective_.awake().clearSleepers(motion_);
  };
  const bool all_free = objective_.allFree();
  const auto newtonStep = [&](const Vec3& net) {
    const Vec3 step = all_free ? objective_.freeMotion(net) : net;
    setMotion(step);
    return Vec3(step * (all_free ? objective_.maxStep(motion_, 1.0)
                                 : objective_.along(motion_, -net.dot(step)).step));
  };
  Vec3 net = objective_.netForce(), step = Vec3::Zero();
  bool at_x = true, evaluated = false;
  for (int trial = 0; trial < trials && net.norm() > least; ++trial) {
    if (at_x) step = newtonStep(net);
    setMotion(step);
    motion_.head(size) += x_.head(size);
    const double there = objective_.evaluate(motion_, gradient_);
    evaluated = true;
    const Vec3 left = objective_.netForce();
    at_x = there <= value + kRounding * std::abs(value) && left.norm() < net.norm() &&
           objective_.residual(gradient_) <= most_residual;
    if (at_x) {
      x_.swap(motion_);
      value = there;
      net = left;
    } else {
      // Too far, because friction or contact set in on the way: to where the force would vanish if it fell
      // evenly.
      const double before = net.dot(step), after = left.dot(step);
      if (!(after < 0.0)) break;
      step *= std::max(0.1, before / (before - after));
    }
  }
  if (!at_x) value = objective_.evaluate(x_, gradient_);
  return evaluated;
}

/// Chooses the initial guess: the minimum of Φ's quadratic model at x⁰ over two directions,
/// inertial motion and the motion that gravity adds, or x⁰ itself if Φ is lower there. In the model
/// contact resists as it does at x⁰, though cloth that sticks there may slide on the way, and layers
/// that press may part. So where the model holds inertia back, the whole inertial motion is tried,
/// too. So is cloth that a fast obstacle carries with it: if only what the obstacle has reached gave way,
/// it would jam below the layers ahead of it. Φ never ends above Φ(x⁰), and motion without new forces, such
/// as free fall, is exact at any tolerance.
/// @return Φ at the guess; gradient_ is its gradient
double StepSolver::chooseInitialGuess() {
  constexpr double kHeldBack = 0.9;  // share of the inertial motion
  const int size = objective_.size();
  const double at_rest =
      objective_.awake().all() ? start_values_.potential : objective_.evaluate(start_, gradient_);
  const ModelMinimum model = minimumOfModel();
  const bool touches = start_values_.contact > 0.0;
  const bool held_back = touches && model.inertial < kHeldBack;
  goAlongDirections(model.inertial, model.fall, x_);
  if (held_back) goAlongDirections(1.0, model.fall_with_inertia, directions_[0]);
  const bool carried = touches && goWithObstacle(directions_[1]);
  double value = objective_.evaluate(x_, gradient_);
  if (objective_.allFree() && netForceStandsOut()) balanceNetForce(value);
  if (held_back) value = takeIfLower(directions_[0], value);
  if (carried) value = takeIfLower(directions_[1], value);
  if (value <= at_rest) return value;
  x_.head(size) = start_.head(size);
  return objective_.evaluate(x_, gradient_);
}

/// Tells whether the net force is a large part of the residual. A solve makes good a small one along with the
/// rest. @pre the last evaluation was at a point with gradient_
bool StepSolver::netForceStandsOut() const {
  constexpr double kShare = 0.3;
  const double net = objective_.netForce().norm() / (cloth_.mass() * objective_.accelerationUnit());
  return net > kShare * objective_.residual(gradient_);
}

/// Makes another guess x_ if Φ is lower there. @param value Φ at x_, the last evaluated point
/// @return Φ at x_, which is then the last evaluated point
double StepSolver::takeIfLower(Vector& other, double value) {
  const double there = objective_.evaluate(other, gradient_);
  if (!(there < value)) return objective_.evaluate(x_, gradient_);
  x_.swap(other);
  return there;
}

/// Moves the awake cloth with the fastest obstacle, as far as no pair of layers comes too near.
/// @return whether an obstacle is fast  @pre the last evaluation was at x⁰
bool StepSolver::goWithObstacle(Vector& x) {
  if (!contacts_.carry(cloth_.nodes(), end_)) return false;
  motion_.head(objective_.size()).setZero();
  objective_.packFree(end_, motion_);
  objective_.awake().clearSleepers(motion_);
  goAlongMotion(x);
  return true;
}

/// Goes from x⁰ along both directions, as far as no pair of layers comes too near. `x` may be one of the
/// directions. @pre the last evaluation was at x⁰
void StepSolver::goAlongDirections(double inertial, double fall, Vector& x) {
  const int size = objective_.size();
  motion_.head(size) = inertial * directions_[0].head(size) + fall * directions_[1].head(size);
  goAlongMotion(x);
}

/// Goes from x⁰ along motion_, as far as no pair of layers comes too near. @pre the last evaluation was at x⁰
void StepSolver::goAlongMotion(Vector& x) {
  const int size = objective_.size();
  const double reach = objective_.maxStep(motion_, 1.0);
  x.head(size) = start_.head(size) + reach * motion_.head(size);
}

/// Minimum of Φ's quadratic model in the plane of the two directions; along their sum if they are
/// parallel.
StepSolver::ModelMinimum StepSolver::minimumOfModel() {
  const double h = cloth_.integrator().stepLength();
  const int size = objective_.size(), free = cloth_.mesh().free;
  for (int n = 0; n < free; ++n) {
    const Vec3 inertial = cloth_.integrator().inertialMotion(n, cloth_.velocities()[n]);
    for (int c = 0; c < 3; ++c) directions_[0][c * free + n] = inertial[c];
  }
  for (int c = 0; c < 3; ++c) {
    directions_[1].segment(c * free, free).setConstant(cloth_.integrator().fall() * scene_.gravity[c]);
  }
  for (Vector& direction : directions_) objective_.awake().clearSleepers(direction);
  for (int k = 0; k < probes_.count(); ++k) {
    const ProbeStep& probe = objective_.probeSteps()[k];
    if (!probe.present) continue;
    const int at = objective_.proxyAt(probe);
    directions_[0].segment<3>(at) = h * probes_.reports()[k].velocity;
    if (probe.turns) directions_[0].segment<3>(at + 3) = h * probes_.spin(k);
    directions_[1].segment(at, probe.unknowns()).setZero();
  }
  motion_.head(size) = directions_[0].head(size) + directions_[1].head(size);
  // If no node is held, gravity's direction deforms nothing, and the sum deforms like inertia's
  // direction.
  const bool deforms = !objective_.allFree();
  const ClothObjective::QuadraticForm inertial = objective_.quadraticForm(directions_[0]);
  const double a = inertial.sum(), b = objective_.quadraticForm(directions_[1], deforms).sum(),
               both = objective_.quadraticForm(motion_, deforms).sum() + (deforms ? 0.0 : inertial.fabric),
               mixed = 0.5 * (both - a - b);
  const double p = -gradient_.head(size).dot(directions_[0].head(size)),
               q = -gradient_.head(size).dot(directions_[1].head(size));
  const double determinant = a * b - mixed * mixed;
  ModelMinimum minimum;
  if (determinant > 1e-9 * a * b) {
    minimum.inertial = (b * p - mixed * q) / determinant;
    minimum.fall = (a * q - mixed * p) / determinant;
  } else {
    minimum.inertial = minimum.fall = both > 0.0 ? (p + q) / both : 0.0;
  }
  minimum.fall_with_inertia = b > 0.0 ? (q - mixed) / b : 0.0;
  return minimum;
}

void StepSolver::serializeCost(Archive& archive) {
  archive("cost.motion", cost_.motion);
  archive("cost.stretch", cost_.stretch);
  archive("cost.bend", cost_.bend);
  archive("cost.shear", cost_.shear);
}

}  // namespace haptic_cloth
