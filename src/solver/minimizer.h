/// Preconditioned conjugate gradient method (Polak-Ribière+) for smooth potentials, independent of
/// cloth.
#pragma once

#include <chrono>

#include "haptic_cloth/options.h"
#include "haptic_cloth/report.h"
#include "parallel/parallel_for.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// Minimizer of an Objective. Apart from rounding, Φ never rises from one iterate to the next, so
/// the result is never worse than the initial guess, however early a limit ends the solve.
class Minimizer {
 public:
  explicit Minimizer(const MinimizerOptions& options) : options_(options) {}

  void setOptions(const MinimizerOptions& options) { options_ = options; }

  /// Reserves scratch memory for up to `size` unknowns; pages that a problem does not use are never
  /// written.
  void reserve(int size);

  /// Starts the time budget, which holds for all solves until the next call.
  void startBudget() { budget_start_ = Clock::now(); }

  /// Improves x in place. @pre x.size() is the reserved size
  MinimizerReport minimize(Objective& objective, Vector& x, Team& team);

  /// Same, if the objective was last evaluated at x, with this value and gradient.
  /// @param least iterations that are made even if the residual is within the tolerance, as limits allow. Φ
  /// falls in them, but a solve that a limit ends then may leave the tolerance.
  MinimizerReport minimize(Objective& objective, Vector& x, double value, const Vector& gradient, Team& team,
                           int least = 0);

 private:
  using Clock = std::chrono::steady_clock;

  void direction(Objective& objective, Team& team, bool restart, MinimizerReport& report);
  double slopeAlongDirection(Objective& objective, Team& team, const Vector& gradient) const;
  double firstStep(Objective& objective, Team& team, const MinimizerReport& report);
  bool lineSearch(Objective& objective, Team& team, Vector& x, double& value, MinimizerReport& report);

  MinimizerOptions options_;
  Vector gradient_, previous_, preconditioned_, direction_, trial_, trial_gradient_;
  double descent_ = 0.0;  ///< g · P g of the last iterate
  int size_ = 0;          ///< number of unknowns of the current problem
  double slope_ = 0.0;    ///< g · d
  Clock::time_point budget_start_ = Clock::now();
};

}  // namespace haptic_cloth
