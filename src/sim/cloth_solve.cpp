// Part of ClothWorld that solves a step.
#include <algorithm>
#include <cmath>

#include "sim/cloth_world.h"

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

/// Solves a step. Contacts are searched within the distance that each node is expected to move. If
/// a node moved farther, a contact may have been missed: the step is solved again with a larger
/// reach.
void ClothWorld::solve(StepReport& report) {
  constexpr int kAttempts = 3;
  const double h = scene.solver.time_step;
  reach_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    reach_[n] =
        2.0 * h * (velocities_[n].norm() + h * scene.gravity.norm()) + 0.1 * std::min(grid.dx, grid.dy);
  }
  for (std::size_t k = 0; k < probes.size(); ++k) {
    // Cloth usually keeps holding back a proxy whose device is far ahead. Without a time limit the
    // reach therefore leaves out most of that distance: if the cloth lets go, the step is solved
    // again.
    double way = (probe_steps_[k].device - probe_steps_[k].proxy).norm();
    if (scene.solver.minimizer.time_budget == 0.0) way = std::min(way, scene.probes[k].radius);
    proxy_reach_[k] = way + 2.0 * h * probes[k].velocity.norm();
  }
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    findContacts(proxy_reach_);
    const MinimizerReport last = minimise();
    report.minimizer = attempt == 0 ? last : sum(report.minimizer, last);
    const bool nodes_covered = covered(), proxies_covered = proxiesCovered(proxy_reach_);
    if ((nodes_covered && proxies_covered) || last.why == Termination::TimeBudget) return;
  }
}

void ClothWorld::findContacts(const std::vector<double>& proxy_reach) {
  touching_.clear();
  for (int k = 0; k < static_cast<int>(probe_steps_.size()); ++k) {
    const ProbeStep& probe = probe_steps_[k];
    ProbeMemory& memory = memories_[k];
    if (!probe.present) continue;
    contacts.startProbe(k, probe.proxy, memory.before, memory.after);
    if (!memory.entered) memory.entered = contacts.isClear(mesh, nodes_, k);
    if (memory.entered) touching_.push_back({k, proxy_reach[k]});
  }
  contacts.collect(mesh, nodes_, reach_, touching_);
}

/// Same as covered(), for the proxies.
bool ClothWorld::proxiesCovered(std::vector<double>& proxy_reach) const {
  bool all = true;
  for (int k = 0; k < static_cast<int>(probe_steps_.size()); ++k) {
    if (!probe_steps_[k].present) continue;
    const double moved = (objective.proxy(k) - probe_steps_[k].proxy).norm();
    all = all && !(moved > proxy_reach[k]);
    proxy_reach[k] = std::max(proxy_reach[k], 2.0 * moved);
  }
  return all;
}

/// Checks that no node moved farther in the last solve than contacts were searched; otherwise
/// widens the reach of all to twice their displacement.
bool ClothWorld::covered() {
  bool all = true;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const double squared = (objective.nodes()[n] - nodes_[n]).squaredNorm();
    if (4.0 * squared <= reach_[n] * reach_[n]) continue;
    const double moved = std::sqrt(squared);
    all = all && !(moved > reach_[n]);
    reach_[n] = std::max(reach_[n], 2.0 * moved);
  }
  return all;
}

/// Minimises over the awake nodes. After each solve everything is evaluated, and sleeping nodes
/// that were pushed wake. The last solve, if it is needed, covers all nodes, so a step reported as
/// converged has converged as a whole.
MinimizerReport ClothWorld::minimise() {
  constexpr int kSolves = 4;
  const double tolerance = scene.solver.minimizer.tolerance;
  objective.begin(nodes_, velocities_, probe_steps_, held_nodes_);
  lookAtRest();
  if (joint_) {
    chooseStart();
    return minimiseJoint();
  }
  MinimizerReport report;
  report.residual = objective.residual(gradient_);
  sleep_.begin(mesh);
  if (sleep_.possible() && held_nodes_.empty()) objective.awake().sleepAll();
  for (int solve = 0; solve < kSolves; ++solve) {
    const bool more = wakeUnrested();
    const bool first = solve == 0 && (objective.awake().all() || objective.size() > 3 * mesh.free);
    const bool left = solve > 0 && report.why == Termination::Converged && report.residual > tolerance;
    if (!more && !first && !left) break;
    if (solve == kSolves - 1) objective.awake().wakeAll();
    const double start = solve == 0 ? chooseStart() : objective.evaluate(x_, gradient_);
    report = sum(report, minimizer_.minimize(objective, x_, start, gradient_, team));
    if (isCut(report)) moveAsAWhole(report);
    const bool ended = report.why == Termination::NotFinite || report.why == Termination::TimeBudget;
    if (objective.awake().all()) break;
    objective.awake().coverAll();  // also after an early end: energies and forces are summed over all
    objective.evaluate(x_, gradient_);
    objective.measureSleepers();
    report.residual = objective.residual(gradient_);
    if (ended) break;
  }
  cost.motion = objective.motionCost();
  return report;
}

/// Wakes nodes that may not sleep at the last evaluated point. @return whether there were any
bool ClothWorld::wakeUnrested() {
  if (objective.awake().all()) return false;
  const double tolerance = scene.solver.minimizer.tolerance * objective.accelerationUnit();
  objective.forcesAtRest(velocities_, forces_);
  sleep_.updateCandidates(mesh, forces_, objective.gradient(), tolerance, objective.awake().flags());
  const bool more = objective.awake().wake(sleep_);
  objective.measureSleepers();
  return more;
}

/// Evaluates Φ and its gradient with all nodes and proxies at x⁰, where the solve starts by
/// default. Contact is sampled anew in each step: what that adds to the contact energy, beside the
/// work of ejecting cloth, must not become motion. If solids move, it cannot be told from their work.
void ClothWorld::lookAtRest() {
  const int size = objective.size();
  objective.pack(nodes_, start_);
  at_rest_ = objective.evaluate(start_, gradient_);
  Sums parts;
  const double internal_energy = objective.internalEnergy(parts);
  sampled_ = solidsMove() ? 0.0 : objective.contactEnergy() - contact_before_ - let_out_;
  energy_before_ =
      internal_energy + objective.couplingEnergy() + objective.lossPotential() - std::max(0.0, created());
  x_.head(size) = start_.head(size);
}

/// Minimises the joint cost; forces and energies are then those of the laws at its positions. The
/// joint cost may fall while Φ rises. If the solve was cut short above Φ(x⁰), which the condensed
/// cost never is, the step stays at the initial guess. Otherwise a step could create any amount of
/// energy.
MinimizerReport ClothWorld::minimiseJoint() {
  const int size = objective.size();
  joint_->begin(start_, x_, joint_x_);
  MinimizerReport report = minimizer_.minimize(*joint_, joint_x_, team);
  cost = joint_->costs();
  motion_.head(size) = x_.head(size);
  x_.head(size) = joint_x_.head(size);
  const double end = objective.evaluate(x_, gradient_);
  if (report.why != Termination::Converged && report.why != Termination::NotFinite && !(end <= at_rest_)) {
    x_.head(size) = motion_.head(size);
    objective.evaluate(x_, gradient_);
    report.why = Termination::LineSearchFailed;
  }
  if (isCut(report)) moveAsAWhole(report);
  return report;
}

/// Corrects the net force after a solve that was cut short: moves all awake cloth alike along that
/// force, to the minimum of Φ's quadratic model. Stiff inner forces do not oppose this motion. The
/// centre of mass of free cloth thus obeys Newton's law however a step ended.
void ClothWorld::moveAsAWhole(MinimizerReport& report) {
  constexpr double kRounding = 1e-10;  // relative to Φ, as in the line search of the minimizer
  const int size = objective.size();
  const double value = objective.evaluate(x_, gradient_);
  motion_.head(size).setZero();
  for (int c = 0; c < 3; ++c) {
    const double force = -gradient_.segment(c * mesh.free, mesh.free).sum();
    for (int n = 0; n < mesh.free; ++n)
      motion_[c * mesh.free + n] = objective.awake().contains(n) ? force : 0.0;
  }
  const double slope = motion_.head(size).dot(gradient_.head(size));
  const Objective::Along along = objective.along(motion_);
  if (!(slope < 0.0) || !(along.curvature > 0.0)) return;
  Vector& trial = ways_[0];
  trial.head(size) = x_.head(size) + std::min(-slope / along.curvature, along.max_step) * motion_.head(size);
  const double moved = objective.evaluate(trial, gradient_);
  const double left = gradient_.head(size).dot(motion_.head(size));
  if (moved <= value + kRounding * std::abs(value) && std::abs(left) <= -slope) {
    x_.head(size) = trial.head(size);
    if (!joint_) report.residual = objective.residual(gradient_);
    if (!joint_) report.value_end = moved;
  } else {
    objective.evaluate(x_, gradient_);
  }
}

/// Chooses the initial guess: the minimum of Φ's quadratic model at x⁰ over two directions,
/// inertial motion and the motion that gravity adds, or x⁰ itself if Φ is lower there. So Φ never
/// ends above Φ(x⁰), and motion without new forces, such as free fall, is exact at any tolerance.
/// @return Φ at the guess; gradient_ is its gradient
double ClothWorld::chooseStart() {
  const int size = objective.size();
  const double at_rest = objective.awake().all() ? at_rest_ : objective.evaluate(start_, gradient_);
  const std::array<double, 2> steps = stepsAlongWays();
  motion_.head(size) = steps[0] * ways_[0].head(size) + steps[1] * ways_[1].head(size);
  const double reach = std::min(1.0, objective.maxStep(motion_));
  x_.head(size) = start_.head(size) + reach * motion_.head(size);
  const double moving = objective.evaluate(x_, gradient_);
  if (moving <= at_rest) return moving;
  x_.head(size) = start_.head(size);
  return objective.evaluate(x_, gradient_);
}

/// Minimum of Φ's quadratic model in the plane of the two directions; along their sum if they are
/// parallel.
std::array<double, 2> ClothWorld::stepsAlongWays() {
  const double h = scene.solver.time_step, share = objective.integrator().inertialTime();
  const int size = objective.size();
  for (int c = 0; c < 3; ++c) {
    ways_[0].segment(c * mesh.free, mesh.free) =
        share * Eigen::Map<const Vector>(velocities_.coordinate(c).data(), mesh.free);
    ways_[1].segment(c * mesh.free, mesh.free).setConstant(share * h * scene.gravity[c]);
  }
  for (Vector& way : ways_) objective.awake().clearSleepers(way);
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const ProbeStep& probe = objective.probeSteps()[k];
    if (!probe.present) continue;
    ways_[0].segment<3>(objective.proxyAt(probe)) = h * probes[k].velocity;
    ways_[1].segment<3>(objective.proxyAt(probe)).setZero();
  }
  motion_.head(size) = ways_[0].head(size) + ways_[1].head(size);
  // If no node is held, gravity's direction deforms nothing, and the sum deforms like inertia's
  // direction.
  const bool deforms = !objective.allFree();
  const ClothObjective::Curvature inertial = objective.curvatureOfWay(ways_[0]);
  const double a = inertial.sum(), b = objective.curvatureOfWay(ways_[1], deforms).sum(),
               both = objective.curvatureOfWay(motion_, deforms).sum() + (deforms ? 0.0 : inertial.fabric),
               mixed = 0.5 * (both - a - b);
  const double p = -gradient_.head(size).dot(ways_[0].head(size)),
               q = -gradient_.head(size).dot(ways_[1].head(size));
  const double determinant = a * b - mixed * mixed;
  if (determinant > 1e-9 * a * b) {
    return {(b * p - mixed * q) / determinant, (a * q - mixed * p) / determinant};
  }
  const double sum = both > 0.0 ? (p + q) / both : 0.0;
  return {sum, sum};
}

}  // namespace haptic_cloth
