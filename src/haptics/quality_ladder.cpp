#include "haptics/quality_ladder.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdio>

namespace haptic_cloth {
namespace {

/// Limits and factors of a rung.
struct Rung {
  int longest_step;        ///< [time steps]
  double tolerance;        ///< at least this [-]
  double angles, strains;  ///< factors of the mesh's thresholds [-]
  int interval;            ///< at least this [-]
  int max_iterations;      ///< at most this [-]
};

// Why this order. A probe slides over a drape (haptic_slide, 5929 particles) and pushes a fold together
// (fold_probe); error of its force, rms, and simulated over wall time on one core
// (docs/decisions/0028-the-node-keeps-the-clock.md):
//
//                                 haptic_slide      fold_probe
//     as asked, 1 ms              0.5 %, 0.22       0.9 %, 1.6
//     tolerance 1, 1 ms           0.5 %, 0.28       0.9 %, 2.7
//     tolerance 1, 2 ms           1.1 %, 0.43       2.4 %, 3.1
//     ... angles x 5/3, 2 ms      1.1 %, 0.62       2.5 %, 3.5
//     ... angles x 8/3, 2 ms      1.3 %, 1.1        2.5 %, 3.6
//     ... angles x 5, 2 ms        1.5 %, 1.9        2.5 %, 3.9
//     ... angles x 5, 4 ms        2.1 %, 2.2        4.7 %, 4.7
//     ... 50 iterations           2.1 %, 2.2        4.9 %, 4.9
//
// The tolerance costs no force. The mesh costs the shape (1 mm becomes 2 to 7 mm) but hardly the force, and
// saves most. Steps beyond 2 ms cost force and save little once the mesh is coarse. Iterations that are cut
// off can ruin folds (0028), so they come last.
constexpr int kAny = INT_MAX;
constexpr double kMostAngle = 4.0, kMostStrain = 10.0;  ///< [rad], [-]
constexpr std::array<Rung, 8> kRungs{{
    {2, 1.0, 1.0, 1.0, 0, kAny},
    {2, 1.0, 5.0 / 3.0, 2.0, 6, kAny},
    {2, 1.0, 8.0 / 3.0, 8.0, 6, kAny},
    {2, 1.0, 5.0, 32.0, 6, kAny},
    {kAny, 1.0, 5.0, 32.0, 6, kAny},
    {kAny, 1.0, 5.0, 32.0, 6, 50},
    {kAny, 1.0, 5.0, 32.0, 6, 20},
    {kAny, 1.0, 5.0, 32.0, 6, 10},
}};

Quality at(const Rung& rung, const Quality& asked, int longest_step) {
  Quality quality = asked;
  MinimizerOptions& minimizer = quality.solver.minimizer;
  quality.longest_step = std::min(longest_step, rung.longest_step);
  minimizer.tolerance = std::max(minimizer.tolerance, rung.tolerance);
  minimizer.max_iterations = std::min(minimizer.max_iterations, rung.max_iterations);
  AdaptOptions& adapt = quality.adapt;
  if (adapt.strategy == Strategy::Finest || adapt.strategy == Strategy::Coarsest) return quality;
  adapt.interval = std::max(adapt.interval, rung.interval);
  // Thresholds that nothing reaches stay within the range of their options.
  const double angles = adapt.refine_above < kMostAngle ? rung.angles : 1.0;
  const double strains = adapt.refine_above_strain < kMostStrain ? rung.strains : 1.0;
  adapt.refine_above *= angles;
  adapt.coarsen_below *= angles;
  adapt.refine_above_strain *= strains;
  adapt.coarsen_below_strain *= strains;
  // Thresholds one rounding apart must not meet.
  adapt.coarsen_below = std::min(adapt.coarsen_below, std::nextafter(adapt.refine_above, 0.0));
  adapt.coarsen_below_strain =
      std::min(adapt.coarsen_below_strain, std::nextafter(adapt.refine_above_strain, 0.0));
  return quality;
}

bool differ(const Quality& a, const Quality& b) {
  return a.longest_step != b.longest_step || a.solver.minimizer.tolerance != b.solver.minimizer.tolerance ||
         a.solver.minimizer.max_iterations != b.solver.minimizer.max_iterations ||
         a.adapt.interval != b.adapt.interval || a.adapt.refine_above != b.adapt.refine_above ||
         a.adapt.refine_above_strain != b.adapt.refine_above_strain;
}

/// Text of what a rung gives up: "tolerance 1, steps to 4 ms, mesh thresholds x 1.7".
std::string givenUp(const Quality& rung, const Quality& asked) {
  std::string text;
  const auto add = [&text](const char* format, double value) {
    char part[64];
    std::snprintf(part, sizeof(part), format, value);
    text += (text.empty() ? "" : ", ") + std::string(part);
  };
  const MinimizerOptions &now = rung.solver.minimizer, &then = asked.solver.minimizer;
  if (now.tolerance != then.tolerance) add("tolerance %.3g", now.tolerance);
  if (rung.longest_step > 1) add("steps to %.3g ms", 1e3 * rung.longest_step * asked.solver.time_step);
  const double angles = rung.adapt.refine_above / asked.adapt.refine_above,
               strains = rung.adapt.refine_above_strain / asked.adapt.refine_above_strain,
               factor = angles != 1.0 ? angles : strains;
  if (factor != 1.0) add("mesh thresholds x %.2g", factor);
  if (now.max_iterations != then.max_iterations) add("%.0f iterations", now.max_iterations);
  return text;
}

}  // namespace

std::vector<Quality> qualityLadder(const SolverOptions& solver, const AdaptOptions& adapt, int longest_step) {
  const Quality asked{solver, adapt, 1, ""};
  std::vector<Quality> ladder{asked};
  for (const Rung& rung : kRungs) {
    Quality next = at(rung, asked, longest_step);
    if (!differ(next, ladder.back())) continue;
    next.given_up = givenUp(next, asked);
    ladder.push_back(next);
  }
  return ladder;
}

}  // namespace haptic_cloth
