#include "tools/summary.h"

#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "haptic_cloth/machine.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using nlohmann::json;

constexpr double kLag = 1e-9;  ///< of an obstacle that is more than rounding [m]

json toJson(const Vec3& v) { return json::array({v.x(), v.y(), v.z()}); }

/// How the run kept the clock, as a line; empty if it did not.
std::string paceText(const RunTotals& totals) {
  if (!totals.pace) return "";
  std::ostringstream text;
  text << std::setprecision(4) << "in real time: " << totals.pace->elapsed << " s elapsed, slipped "
       << totals.pace->slipped << " s, quality rung " << totals.pace->mean_rung << " in the mean, "
       << totals.pace->worst_rung << " at worst, steps up to " << 1e3 * totals.pace->longest_step << " ms\n";
  return text.str();
}

}  // namespace

double realTimeFactor(const Simulation& simulation, const RunTotals& totals) {
  return totals.wall_time > 0.0 ? (simulation.time() - totals.start_time) / totals.wall_time : 0.0;
}

std::string summaryJson(const Simulation& simulation, const RunTotals& totals, bool succeeded) {
  const EnergyReport energy = simulation.energy();
  const CostReport cost = simulation.cost();
  json summary;
  summary["succeeded"] = succeeded;
  summary["simulated_time"] = simulation.time();
  summary["wall_time"] = totals.wall_time;
  summary["real_time_factor"] = realTimeFactor(simulation, totals);
  summary["at_rest"] = totals.at_rest;
  if (totals.pace) {
    summary["pace"] = {{"elapsed", totals.pace->elapsed},
                       {"slipped", totals.pace->slipped},
                       {"mean_rung", totals.pace->mean_rung},
                       {"worst_rung", totals.pace->worst_rung},
                       {"longest_step", totals.pace->longest_step}};
  }
  summary["steps"] = totals.steps;
  summary["iterations"] = totals.iterations;
  summary["evaluations"] = totals.evaluations;
  summary["failed_steps"] = totals.failed_steps;
  summary["converged_steps"] = totals.converged_steps;
  summary["threads"] = simulation.threads();
  summary["processor"] = processorName();
  summary["simd"] = instructionSet();
  summary["particles"] = simulation.scene().cloth.particles;
  summary["active_particles"] = {{"min", totals.min_active},
                                 {"mean", totals.mean_active},
                                 {"max", totals.max_active},
                                 {"final", simulation.activeParticles()}};
  summary["refined"] = totals.refined;
  summary["coarsened"] = totals.coarsened;
  summary["residual"] = totals.last.minimizer.residual;
  summary["max_residual"] = totals.max_residual;
  summary["cost"] = {{"total", cost.total()},
                     {"motion", cost.motion},
                     {"stretch", cost.stretch},
                     {"bend", cost.bend},
                     {"shear", cost.shear}};
  summary["energy"] = {
      {"total", energy.total()},   {"kinetic", energy.kinetic},   {"gravity", energy.gravity},
      {"stretch", energy.stretch}, {"bend", energy.bend},         {"shear", energy.shear},
      {"contact", energy.contact}, {"coupling", energy.coupling}, {"dissipated", energy.dissipated}};
  summary["max_strain"] = simulation.maxStrain();
  summary["max_speed"] = simulation.maxSpeed();
  summary["max_penetration"] = totals.max_penetration;
  summary["max_obstacle_lag"] = totals.max_obstacle_lag;
  summary["self_contacts"] = totals.last.self_contacts;
  // JSON has no infinity: null, if nothing came near.
  summary["min_self_gap"] = std::isfinite(totals.min_self_gap) ? json(totals.min_self_gap) : json();
  summary["crossings"] = simulation.crossings().pairs;
  const std::vector<ProbeOptions>& probes = simulation.scene().probes;
  summary["probe_force"] = toJson(simulation.probe().force);
  summary["probe_force_of"] = probes.front().name;
  for (std::size_t k = 0; k < probes.size() && probes.size() > 1; ++k) {
    summary["probe_forces"][probes[k].name] = toJson(simulation.probe(static_cast<int>(k)).force);
  }
  summary["support_force"] = toJson(simulation.supportForce());
  summary["mass"] = simulation.mass();
  // A 64-bit integer would not survive readers that keep JSON numbers as doubles.
  summary["state_hash"] = hexadecimalText(simulation.stateHash());
  return summary.dump(2);
}

std::string briefReport(const Simulation& simulation, const RunTotals& totals) {
  const double steps = totals.steps > 0 ? totals.steps : 1;
  std::ostringstream text;
  text << std::setprecision(4);
  text << "simulated " << simulation.time() - totals.start_time << " s ";
  if (totals.start_time > 0.0) text << "(from " << totals.start_time << " to " << simulation.time() << " s) ";
  text << "in " << totals.wall_time << " s (real-time factor " << realTimeFactor(simulation, totals) << ", "
       << simulation.threads() << " threads)" << (totals.at_rest ? ", at rest" : "") << "\n"
       << paceText(totals) << "steps " << totals.steps << ", converged " << totals.converged_steps
       << ", failed " << totals.failed_steps << ", iterations " << totals.iterations << " ("
       << totals.iterations / steps << " a step), last " << toString(totals.last.minimizer.why) << "\n"
       << "active particles " << totals.min_active << " to " << totals.max_active << ", mean "
       << totals.mean_active << ", final " << simulation.activeParticles() << "\n"
       << "processor " << processorName() << "; kernels for " << instructionSet() << "\n"
       << "max strain " << 100.0 * simulation.maxStrain() << " %, max speed " << simulation.maxSpeed()
       << " m/s, max penetration " << 1e3 * totals.max_penetration << " mm\n"
       << "support force " << simulation.supportForce().transpose() << " N";
  const std::vector<ProbeOptions>& probes = simulation.scene().probes;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const ProbeReport probe = simulation.probe(static_cast<int>(k));
    if (!probe.present) continue;
    text << ", force on " << (probes.size() == 1 ? "the probe" : probes[k].name) << " "
         << probe.force.transpose() << " N";
  }
  if (totals.max_obstacle_lag > kLag)
    text << "\nan obstacle lagged behind its path by up to " << 1e3 * totals.max_obstacle_lag
         << " mm: in one step it moves by at most a quarter of its narrowest half-width";
  const int short_steps = totals.steps - totals.converged_steps;
  if (short_steps > 0) {
    text << "\n"
         << short_steps << " steps ended short of solver.tolerance, with a residual of up to "
         << totals.max_residual << ": more solver.max_iterations or a shorter solver.time_step may help";
  }
  return text.str();
}

}  // namespace haptic_cloth
