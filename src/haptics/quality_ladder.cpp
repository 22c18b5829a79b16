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
  double angles, strains;  ///< factors of the mesh's thresholds far from probes [-]
  double near_reach;       ///< what is near: at most this [finest cells]
  double near_load;        ///< what carries load: at least this [-]
  int interval;            ///< at least this [-]
  int max_iterations;      ///< at most this [-]
};

// Why this order (figures in docs/decisions/0028-the-node-keeps-the-clock.md): the tolerance costs no force.
// The mesh costs the shape (1 mm becomes 2 to 7 mm) but hardly the force, and saves most. Steps beyond 2 ms
// catch up after stalls. Iterations that are cut off cost a fold up to a quarter of its force. They are cut
// in steps of 2 ms first: with as many iterations in the same time, twice as long steps save little, and
// where they end short they are far less accurate.
constexpr int kAny = INT_MAX;
constexpr double kAll = HUGE_VAL;
constexpr double kNoLoad = 100.0;                       ///< more than a cell carries [-]
constexpr double kMostAngle = 4.0, kMostStrain = 10.0;  ///< [rad], [-]
constexpr double kMostFactor = 1000.0;                  ///< the largest that the option takes [-]
constexpr std::array<Rung, 9> kRungs{{
    {2, 1.0, 1.0, 1.0, kAll, 0.0, 0, kManyIterations},
    {2, 1.0, 5.0 / 3.0, 2.0, kAll, 0.0, 6, kManyIterations},
    {2, 1.0, 8.0 / 3.0, 8.0, kAll, 0.0, 6, kManyIterations},
    {2, 1.0, 5.0, 32.0, kAll, 0.0, 6, kManyIterations},
    {2, 1.0, 5.0, 32.0, 4.0, 0.1, 6, kManyIterations},
    {kAny, 1.0, 5.0, 32.0, 2.0, kNoLoad, 6, kManyIterations},
    {2, 1.0, 5.0, 32.0, 2.0, kNoLoad, 6, 20},
    {2, 1.0, 5.0, 32.0, 2.0, kNoLoad, 6, 10},
    {kAny, 1.0, 5.0, 32.0, 2.0, kNoLoad, 6, 10},
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
  // A factor of thresholds that nothing reaches would give up nothing.
  const double angles = adapt.refine_above < kMostAngle ? rung.angles : 1.0;
  const double strains = adapt.refine_above_strain < kMostStrain ? rung.strains : 1.0;
  adapt.far_angle_factor = std::min(angles * adapt.far_angle_factor, kMostFactor);
  adapt.far_strain_factor = std::min(strains * adapt.far_strain_factor, kMostFactor);
  if (angles > 1.0 || strains > 1.0) {
    adapt.near_reach = std::min(adapt.near_reach, rung.near_reach);
    adapt.near_load = std::max(adapt.near_load, rung.near_load);
  }
  return quality;
}

bool differ(const Quality& a, const Quality& b) {
  return a.longest_step != b.longest_step || a.solver.minimizer.tolerance != b.solver.minimizer.tolerance ||
         a.solver.minimizer.max_iterations != b.solver.minimizer.max_iterations ||
         a.adapt.interval != b.adapt.interval || a.adapt.far_angle_factor != b.adapt.far_angle_factor ||
         a.adapt.far_strain_factor != b.adapt.far_strain_factor || a.adapt.near_reach != b.adapt.near_reach ||
         a.adapt.near_load != b.adapt.near_load;
}

/// Tells whether a rung costs less than the one before. Shorter steps do so where they have fewer iterations.
bool saves(const Quality& rung, const Quality& before) {
  const bool cuts = rung.solver.minimizer.max_iterations < before.solver.minimizer.max_iterations;
  return differ(rung, before) && (cuts || rung.longest_step >= before.longest_step);
}

/// Text of what a rung gives up: "tolerance 1, steps to 2 ms, mesh thresholds x 1.7 beyond 8 cells of probes
/// and below 3 % of their load".
std::string givenUp(const Quality& rung, const Quality& asked) {
  std::string text;
  const auto append = [&text](const char* format, double value) {
    char part[64];
    std::snprintf(part, sizeof(part), format, value);
    text += part;
  };
  const auto add = [&](const char* format, double value) {
    if (!text.empty()) text += ", ";
    append(format, value);
  };
  const MinimizerOptions &now = rung.solver.minimizer, &then = asked.solver.minimizer;
  if (now.tolerance != then.tolerance) add("tolerance %.3g", now.tolerance);
  if (rung.longest_step > 1) add("steps to %.3g ms", 1e3 * rung.longest_step * asked.solver.time_step);
  const double angles = rung.adapt.far_angle_factor / asked.adapt.far_angle_factor,
               strains = rung.adapt.far_strain_factor / asked.adapt.far_strain_factor,
               factor = angles != 1.0 ? angles : strains;
  if (factor != 1.0) {
    add("mesh thresholds x %.2g", factor);
    append(" beyond %.3g cells of probes", rung.adapt.near_reach);
    if (rung.adapt.near_load < kNoLoad)
      append(" and below %.3g %% of their load", 100.0 * rung.adapt.near_load);
  }
  if (now.max_iterations != then.max_iterations) add("%.0f iterations", now.max_iterations);
  return text;
}

}  // namespace

std::vector<Quality> qualityLadder(const SolverOptions& solver, const AdaptOptions& adapt, int longest_step) {
  const Quality asked{solver, adapt, 1, ""};
  std::vector<Quality> ladder{asked};
  for (const Rung& rung : kRungs) {
    Quality next = at(rung, asked, longest_step);
    if (!saves(next, ladder.back())) continue;
    next.given_up = givenUp(next, asked);
    ladder.push_back(next);
  }
  return ladder;
}

}  // namespace haptic_cloth
