#include "tools/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

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
  totals.converged_steps += report.minimizer.why == Termination::Converged ? 1 : 0;
  totals.max_residual = std::max(totals.max_residual, report.minimizer.residual);
  totals.min_active =
      totals.steps == 1 ? report.active_particles : std::min(totals.min_active, report.active_particles);
  totals.max_active = std::max(totals.max_active, report.active_particles);
  totals.mean_active += (report.active_particles - totals.mean_active) / totals.steps;
  totals.refined += report.refined;
  totals.coarsened += report.coarsened;
  totals.max_penetration = std::max(totals.max_penetration, report.max_penetration);
  totals.min_self_gap = std::min(totals.min_self_gap, report.min_self_gap);
  totals.wall_time += wall_time;
  totals.last = report;
}

}  // namespace

RunRecord runSteps(Simulation& simulation, Rows rows, const NextStep& next, const StepCallback& after_step) {
  RunRecord record;
  record.probes.resize(simulation.scene().probes.size());
  record.totals.start_time = simulation.time();
  for (int length = 1; next(simulation, length);) {
    const auto start = std::chrono::steady_clock::now();
    const StepReport report = simulation.step(length);
    const double wall_time = secondsSince(start);
    add(report, wall_time, record.totals);
    if (rows == Rows::All) record.steps.push_back({report, simulation.energy(), wall_time});
    for (std::size_t k = 0; rows != Rows::None && k < record.probes.size(); ++k) {
      const ProbeReport probe = simulation.probe(static_cast<int>(k));
      if (probe.present) record.probes[k].push_back({simulation.time(), probe});
    }
    if (after_step) after_step(simulation, record.totals);
  }
  RunTotals& totals = record.totals;
  if (totals.steps == 0)
    totals.mean_active = totals.min_active = totals.max_active = simulation.activeParticles();
  return record;
}

namespace {

/// Largest distance of an obstacle from where its path says it should be [m].
double obstacleLag(const Simulation& simulation) {
  const std::vector<Obstacle>& obstacles = simulation.scene().obstacles;
  double lag = 0.0;
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (obstacles[k].path.empty()) continue;
    const Vec3 place = simulation.obstaclePose(static_cast<int>(k)).position;
    lag = std::max(lag, (pathPosition(obstacles[k].path, simulation.time()) - place).norm());
  }
  return lag;
}

/// Watches a run whose probes and obstacles follow the paths of the scene: when it stops, and how far
/// obstacles lag.
class ScriptedRun {
 public:
  explicit ScriptedRun(const Simulation& simulation)
      : stop_(simulation.scene().stop), slack_(0.5 * simulation.scene().solver.time_step) {
    slow_since_ = simulation.time();
    for (const ProbeOptions& probe : simulation.scene().probes) {
      if (!probe.path.empty()) scripted_until_ = std::max(scripted_until_, probe.path.back().time);
      for (const auto& times : probe.grasp) scripted_until_ = std::max(scripted_until_, times[1]);
    }
    for (const Obstacle& obstacle : simulation.scene().obstacles) {
      if (!obstacle.path.empty()) scripted_until_ = std::max(scripted_until_, obstacle.path.back().time);
    }
  }

  /// Called before each step, and after the last one.
  bool ends(const Simulation& now) {
    max_lag_ = std::max(max_lag_, obstacleLag(now));
    if (!(now.maxSpeed() < stop_.rest_speed) || now.time() < scripted_until_) slow_since_ = now.time();
    at_rest_ = stop_.rest_speed > 0.0 && now.time() - slow_since_ >= kRestDuration - slack_;
    return at_rest_ || !(now.time() < stop_.time - slack_);
  }

  void report(RunTotals& totals) const {
    totals.at_rest = at_rest_;
    totals.max_obstacle_lag = max_lag_;
  }

 private:
  StopOptions stop_;
  double slack_;  ///< half a step: many time steps may end a rounding error short of their limit [s]
  double scripted_until_ = 0.0;  ///< end of all paths and grasps [s]
  double slow_since_, max_lag_ = 0.0;
  bool at_rest_ = false;
};

}  // namespace

RunRecord runScene(Simulation& simulation, Rows rows, const StepCallback& after_step) {
  ScriptedRun run(simulation);
  const auto next = [&run](Simulation& now, int&) {
    if (run.ends(now)) return false;
    followPaths(now);
    return true;
  };
  RunRecord record = runSteps(simulation, rows, next, after_step);
  run.report(record.totals);
  return record;
}

RunRecord runInRealTime(Simulation& simulation, Rows rows, const StepCallback& after_step) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  ScriptedRun run(simulation);
  StepPacer pacer(simulation);
  PaceTotals pace;
  const auto next = [&](Simulation& now, int& length) {
    if (run.ends(now)) return false;
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(pacer.due(secondsSince(start)))));
    length = pacer.begin(now, secondsSince(start));
    followPaths(now, length);
    return true;
  };
  const double start_time = simulation.time();
  const auto after = [&](const Simulation& now, const RunTotals& totals) {
    pace.elapsed = secondsSince(start);
    pacer.end(totals.last, pace.elapsed);
    const QualityReport quality = pacer.quality();
    pace.slipped = quality.slipped;
    pace.worst_rung = std::max(pace.worst_rung, quality.rung);
    pace.longest_step = std::max(pace.longest_step, quality.step_length);
    pace.mean_rung += quality.step_length / (now.time() - start_time) * (quality.rung - pace.mean_rung);
    if (after_step) after_step(now, totals);
  };
  RunRecord record = runSteps(simulation, rows, next, after);
  pacer.restoreQuality(simulation);  // a state that is saved now holds the scene's own options
  run.report(record.totals);
  record.totals.pace = pace;
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
