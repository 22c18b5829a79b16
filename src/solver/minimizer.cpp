#include "solver/minimizer.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

// Iterations before the preconditioner is fitted again; each later interval ends at twice as many
// iterations as the last. Contacts and folds change the Hessian while they form, but a long solve
// of a stiff, steady problem must keep its conjugate directions.
constexpr int kFirstRenewal = 15;

// Most solves end before this. What helps only where layers jam would slow them down, and disturb those of
// which few iterations are asked.
constexpr int kLong = 30;

bool isLong(const MinimizerReport& report) { return report.iterations >= kLong; }

}  // namespace

const char* toString(Termination why) {
  switch (why) {
    case Termination::Converged:
      return "converged";
    case Termination::IterationLimit:
      return "iteration_limit";
    case Termination::TimeBudget:
      return "time_budget";
    case Termination::LineSearchFailed:
      return "line_search_failed";
    case Termination::NotFinite:
      return "not_finite";
    case Termination::OutOfReach:
      break;
  }
  return "out_of_reach";
}

void Minimizer::reserve(int size) {
  for (Vector* v : {&gradient_, &previous_, &preconditioned_, &direction_, &trial_, &trial_gradient_}) {
    v->resize(size);
  }
}

MinimizerReport Minimizer::minimize(Objective& objective, Vector& x, Team& team) {
  const double value = objective.evaluate(x, trial_gradient_);
  MinimizerReport report = minimize(objective, x, value, trial_gradient_, team);
  ++report.evaluations;
  return report;
}

MinimizerReport Minimizer::minimize(Objective& objective, Vector& x, double value, const Vector& gradient,
                                    Team& team, int least) {
  constexpr double kExact = 0.01;  // of the tolerance: not worth an iteration
  const auto start = Clock::now();
  const auto since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };

  size_ = objective.size();
  gradient_.head(size_) = gradient.head(size_);
  MinimizerReport report;
  report.value_start = value;
  int renewal = 0;
  bool restart = true;
  while (true) {
    report.residual = objective.residual(gradient_);
    if (!std::isfinite(value) || !std::isfinite(report.residual)) {
      report.why = Termination::NotFinite;
      break;
    }
    report.why = Termination::Converged;
    const bool converged = report.residual <= options_.tolerance;
    if (converged && (report.iterations >= least || report.residual <= kExact * options_.tolerance)) break;
    const auto stop = [&](Termination why) { report.why = converged ? Termination::Converged : why; };
    if (report.iterations >= options_.max_iterations) {
      stop(Termination::IterationLimit);
      break;
    }
    if (options_.time_budget > 0.0 && (report.iterations > 0 || converged) &&
        since(budget_start_) > options_.time_budget) {
      stop(Termination::TimeBudget);
      break;
    }
    if (report.iterations >= renewal) {
      objective.fitPreconditioner(isLong(report));
      renewal = std::max(kFirstRenewal, 2 * renewal);
      restart = true;
    }
    direction(objective, team, restart, report);
    const bool steepest = restart;
    restart = !lineSearch(objective, team, x, value, report);
    if (restart && steepest) {
      stop(Termination::LineSearchFailed);
      break;
    }
    ++report.iterations;
  }
  report.value_end = value;
  report.seconds = since(start);
  return report;
}

/// Computes d ← -P g + β d with β = max(0, g·P(g - g_previous) / g_previous·P g_previous),
/// Polak-Ribière+.
void Minimizer::direction(Objective& objective, Team& team, bool restart, MinimizerReport& report) {
  objective.precondition(gradient_, preconditioned_);
  const Sums dots = team.sum(
      size_,
      [&](int begin, int end) {
        const auto z = preconditioned_.segment(begin, end - begin);
        Sums sums = Sums::Zero();
        sums[0] = z.dot(gradient_.segment(begin, end - begin));
        if (!restart) sums[1] = z.dot(previous_.segment(begin, end - begin));
        return sums;
      },
      Team::kEntry, objective.order());
  const double beta = restart ? 0.0 : std::max(0.0, (dots[0] - dots[1]) / descent_);
  descent_ = dots[0];
  const Sums slope = team.sum(
      size_,
      [&](int begin, int end) {
        auto d = direction_.segment(begin, end - begin);
        const auto z = preconditioned_.segment(begin, end - begin);
        if (beta > 0.0) {
          d = beta * d - z;
        } else {
          d = -z;
        }
        Sums sums = Sums::Zero();
        sums[0] = d.dot(gradient_.segment(begin, end - begin));
        return sums;
      },
      Team::kEntry, objective.order());
  slope_ = slope[0];
  if (!(slope_ < 0.0)) {
    direction_.head(size_) = -preconditioned_.head(size_);
    slope_ = -descent_;
    ++report.restarts;
  }
}

double Minimizer::slopeAlongDirection(Objective& objective, Team& team, const Vector& gradient) const {
  const auto of_part = [&](int begin, int end) {
    Sums sums = Sums::Zero();
    sums[0] = direction_.segment(begin, end - begin).dot(gradient.segment(begin, end - begin));
    return sums;
  };
  return team.sum(size_, of_part, Team::kEntry, objective.order())[0];
}

/// Newton's step along d, or the largest admissible one. If in a long solve that is much less than Newton's,
/// a few constraints stop all unknowns. Then d is bent around them, if that promises to lower Φ further.
double Minimizer::firstStep(Objective& objective, Team& team, const MinimizerReport& report) {
  constexpr double kMuch = 0.2;  // of Newton's step
  const auto promise = [](double slope, const Objective::Along& along) {
    return -along.step * (slope + 0.5 * along.step * along.quadratic_form);
  };
  const Objective::Along straight = objective.along(direction_, slope_);
  const double newton = Objective::newtonStep(slope_, straight.quadratic_form);
  if (!isLong(report) || !(straight.step < kMuch * newton)) return straight.step;
  trial_.head(size_) = direction_.head(size_);
  if (!objective.keepClear(direction_, newton)) return straight.step;
  const double slope = slopeAlongDirection(objective, team, gradient_);
  const Objective::Along bent = objective.along(direction_, slope);
  if (slope < 0.0 && promise(slope, bent) > promise(slope_, straight)) {
    slope_ = slope;
    return bent.step;
  }
  direction_.head(size_) = trial_.head(size_);
  return straight.step;
}

/// Takes the first step along d, then backtracks (Armijo). A step that goes far beyond the minimum is
/// shortened once, to where the slope would vanish on a straight line (Wolfe's second condition): the next
/// direction would climb from there, so a solve would restart in each iteration. If Φ changes less than its
/// rounding error, the slope decides [Hager & Zhang 2005, approximate Wolfe]. That error, kRounding, is far
/// above the rounding of a sum: curvatures are second differences of positions with an error of
/// ε x/l². On success the iterate, its value and its gradient are the new ones.
/// @return whether a step was accepted
bool Minimizer::lineSearch(Objective& objective, Team& team, Vector& x, double& value,
                           MinimizerReport& report) {
  constexpr double kSufficient = 1e-4, kRounding = 1e-10;
  constexpr double kFar = 0.5;  // slope at the end over that at the start: beyond the minimum by far [-]
  constexpr int kTrials = 20;
  double step = firstStep(objective, team, report);
  bool may_shorten = true;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto go = [&](int begin, int end) {
      trial_.segment(begin, end - begin) =
          x.segment(begin, end - begin) + step * direction_.segment(begin, end - begin);
    };
    team.forRange(size_, go, Team::kEntry, objective.order());
    const double trial_value = objective.evaluate(trial_, trial_gradient_);
    ++report.evaluations;
    const double change = trial_value - value;
    const double end_slope = slopeAlongDirection(objective, team, trial_gradient_);
    const bool decreases = change <= kSufficient * step * slope_;
    const bool level = std::abs(change) <= kRounding * (std::abs(value) + std::abs(trial_value)) &&
                       end_slope <= (2.0 * kSufficient - 1.0) * slope_;
    if (decreases && may_shorten && end_slope > -kFar * slope_ && std::isfinite(end_slope)) {
      may_shorten = false;
      step *= slope_ / (slope_ - end_slope);
      continue;
    }
    if (std::isfinite(trial_value) && (decreases || level)) {
      x.swap(trial_);
      previous_.swap(gradient_);
      gradient_.swap(trial_gradient_);
      value = trial_value;
      return true;
    }
    // Minimum of the parabola through value, slope and trial, limited to 0.1 … 0.5 of the step.
    const double parabola = -0.5 * slope_ * step * step / (change - slope_ * step);
    step = std::isfinite(parabola) ? std::clamp(parabola, 0.1 * step, 0.5 * step) : 0.1 * step;
  }
  value = objective.evaluate(x, gradient_);  // the objective's point must be the iterate again
  ++report.evaluations;
  return false;
}

}  // namespace haptic_cloth
