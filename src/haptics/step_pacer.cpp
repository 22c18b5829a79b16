#include "haptic_cloth/step_pacer.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptics/clock_keeper.h"
#include "haptics/quality_ladder.h"
#include "state/number_text.h"

namespace haptic_cloth {

namespace {

void check(const PaceOptions& options) {
  if (options.max_time_step > 0.0 && std::isfinite(options.max_time_step)) return;
  throw InputError("pace options", "max_time_step", shortestText(options.max_time_step),
                   "must be finite and > 0");
}

}  // namespace

class StepPacer::Implementation {
 public:
  explicit Implementation(double time_step) : clock(time_step), time_step_(time_step) {}

  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping,
                  const PaceOptions& options) {
    check(options);
    constexpr double kRounding = 1e-9, kMost = 1e6;  // in steps
    const double longest = std::min(options.max_time_step / time_step_ + kRounding, kMost);
    ladder_ = qualityLadder(solver, adapt, std::max(1, static_cast<int>(longest)));
    if (!options.keep_clock) ladder_.resize(1);
    std::vector<int> longest_steps;
    const int many = std::min(kManyIterations, solver.minimizer.max_iterations);
    int gentle = 0;  // rungs that let nearly all steps converge
    for (const Quality& rung : ladder_) {
      longest_steps.push_back(rung.longest_step);
      if (rung.solver.minimizer.max_iterations >= many) ++gentle;
    }
    clock.setRungs(longest_steps, gentle);
    air_damping_ = air_damping;
    rung_ = kUnknown;
  }

  /// Gives the simulation the options of a rung.
  void setQuality(int rung, Simulation& simulation) {
    if (rung == rung_) return;
    rung_ = rung;
    simulation.setOptions(ladder_[rung].solver, ladder_[rung].adapt, air_damping_);
  }

  QualityReport quality() const {
    const int rung = std::max(0, rung_);
    return {rung, ladder_[rung].given_up, length * time_step_, clock.slipped()};
  }

  ClockKeeper clock;
  int length = 0;  ///< of the last step, in time steps

 private:
  static constexpr int kUnknown = -1;

  double time_step_;  ///< [s]
  std::vector<Quality> ladder_;
  double air_damping_ = 0.0;  ///< asked for [1/s]
  int rung_ = kUnknown;       ///< whose options the simulation has
};

StepPacer::StepPacer(const Simulation& simulation, const PaceOptions& options)
    : implementation_(std::make_unique<Implementation>(simulation.scene().solver.time_step)) {
  const Scene& scene = simulation.scene();
  setOptions(scene.solver, scene.adapt, scene.air_damping, options);
}

StepPacer::~StepPacer() = default;
StepPacer::StepPacer(StepPacer&&) noexcept = default;
StepPacer& StepPacer::operator=(StepPacer&&) noexcept = default;

void StepPacer::setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping,
                           const PaceOptions& options) {
  implementation_->setOptions(solver, adapt, air_damping, options);
}

double StepPacer::due(double now) const { return implementation_->clock.due(now); }

int StepPacer::begin(Simulation& simulation, double now) {
  const ClockKeeper::Step step = implementation_->clock.begin(now);
  implementation_->setQuality(step.rung, simulation);
  implementation_->length = step.length;
  return step.length;
}

void StepPacer::end(const StepReport& step, double now) {
  implementation_->clock.end(now, step.minimizer.why == Termination::IterationLimit);
}

void StepPacer::restart() { implementation_->clock.restart(); }

void StepPacer::restoreQuality(Simulation& simulation) { implementation_->setQuality(0, simulation); }

QualityReport StepPacer::quality() const { return implementation_->quality(); }

}  // namespace haptic_cloth
