#include "tools/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace haptic_cloth {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void add(const StepReport& report, double wall_time, RunTotals& totals) {
  ++totals.steps;
  totals.iterations += report.minimizer.iterations;
  totals.evaluations += report.minimizer.evaluations;
  totals.failed_steps += report.failed ? 1 : 0;
  totals.min_active =
      totals.steps == 1 ? report.active_particles : std::min(totals.min_active, report.active_particles);
  totals.max_active = std::max(totals.max_active, report.active_particles);
  totals.mean_active += (report.active_particles - totals.mean_active) / totals.steps;
  totals.refined += report.refined;
  totals.coarsened += report.coarsened;
  totals.max_penetration = std::max(totals.max_penetration, report.max_penetration);
  totals.wall_time += wall_time;
  totals.last = report;
}

}  // namespace

RunRecord runSteps(Simulation& simulation, bool keep_rows, const NextStep& next,
                   const StepCallback& after_step) {
  RunRecord record;
  record.probes.resize(simulation.scene().probes.size());
  record.totals.start_time = simulation.time();
  for (int length = 1; next(simulation, length);) {
    const auto start = std::chrono::steady_clock::now();
    const StepReport report = simulation.step(length);
    const double wall_time = secondsSince(start);
    add(report, wall_time, record.totals);
    if (keep_rows) {
      record.steps.push_back({report, simulation.energy(), wall_time});
      for (std::size_t k = 0; k < record.probes.size(); ++k) {
        const ProbeReport probe = simulation.probe(static_cast<int>(k));
        if (probe.present) record.probes[k].push_back({simulation.time(), probe});
      }
    }
    if (after_step) after_step(simulation, record.totals);
  }
  return record;
}

RunRecord runScene(Simulation& simulation, bool keep_rows, const StepCallback& after_step) {
  const StopOptions stop = simulation.scene().stop;
  // Half a step of slack: the sum of many time steps may end a rounding error short of its limit.
  const double slack = 0.5 * simulation.scene().solver.time_step;
  double slow_since = simulation.time();
  bool at_rest = false;
  const auto next = [&](Simulation& now, int&) {
    if (!(now.maxSpeed() < stop.rest_speed)) slow_since = now.time();
    at_rest = stop.rest_speed > 0.0 && now.time() - slow_since >= kRestDuration - slack;
    if (at_rest || !(now.time() < stop.time - slack)) return false;
    followPaths(now);
    return true;
  };
  RunRecord record = runSteps(simulation, keep_rows, next, after_step);
  record.totals.at_rest = at_rest;
  return record;
}

bool isFinite(const Simulation& simulation) {
  std::vector<Vec3> positions;
  simulation.positions(positions);
  const bool positions_finite =
      std::all_of(positions.begin(), positions.end(), [](const Vec3& x) { return x.allFinite(); });
  return positions_finite && std::isfinite(simulation.energy().total()) &&
         std::isfinite(simulation.maxSpeed());
}

}  // namespace haptic_cloth
