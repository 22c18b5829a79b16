/// Force law with hysteresis: play between the two branches of a measured loop.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "haptic_cloth/curve.h"

namespace haptic_cloth {

/// Force law of a deformation s (strain [-], curvature [1/m] or shear angle [rad]) with memory:
///
///     f(s) = R(s) + clamp(q, lower(s) - R(s), upper(s) - R(s)).
///
/// upper and lower are the branches of the outer loop. R is the path after a reversal. q, the play,
/// is the only number that an element remembers. R rises faster than both branches everywhere (at
/// least `reversal` times the steeper), so a path leaves one branch, follows R and joins the other.
/// Inner cycles stay inside the loop, close, dissipate and do not ratchet (play operator [Visintin
/// 1994, III.2]). The law is elastic where the branches coincide; it has no memory if they coincide
/// everywhere.
class Loop {
 public:
  using Point = Curve::Point;

  /// Law of one element while its play is constant: the path between `low` and `high`, the branches
  /// beyond.
  struct Step {
    double play;                ///< q
    double low, high;           ///< deformations where the path meets the lower, upper branch
    double on_lower, on_upper;  ///< offsets of the branches' integrals that make ψ continuous
  };

  /// f = 0.
  Loop() : Loop(Curve()) {}

  /// Elastic law without memory.
  Loop(const Curve& elastic) : upper_(elastic) {}  // NOLINT: an elastic law is a loop

  /// @param upper, lower branches on one grid begin, begin + step, ...; upper >= lower, both
  /// non-decreasing. Beyond the last sample both continue with the last slope of the upper branch,
  /// before the first with the first slope of the lower.
  /// @param reversal ratio of the slope of R to that of the steeper branch, > 1
  /// @param longest_crossing R is so steep that it crosses the loop within this deformation, > 0
  /// @throws InputError if lengths differ, there are less than two samples, lower lies above upper, or a
  /// number is out of its range
  Loop(double begin, double step, std::vector<double> upper, std::vector<double> lower, double reversal,
       double longest_crossing = std::numeric_limits<double>::infinity());

  bool hasMemory() const { return memory_; }
  bool isZero() const { return !memory_ && upper_.isZero(); }

  /// Rising branch; the law itself if it has no memory.
  const Curve& upper() const { return upper_; }

  /// Falling branch.
  const Curve& lower() const { return memory_ ? lower_ : upper_; }

  /// R, the path after a reversal. @pre hasMemory()
  const Curve& path() const { return path_; }

  /// Play of an element that was never deformed.
  double initialPlay() const { return memory_ ? clampPlay(0.0, 0.0) : 0.0; }

  /// Play after a step that ends at deformation s.
  double commit(double play, double s) const { return memory_ ? clampPlay(play, s) : 0.0; }

  /// Play that gives `force` at s, or the nearest that the loop allows; used when the mesh changes.
  double playFor(double force, double s) const {
    return memory_ ? clampPlay(force - path_(s).force, s) : 0.0;
  }

  /// Force at s after commit(play, s).
  double force(double play, double s) const {
    return memory_ ? path_(s).force + clampPlay(play, s) : upper_(s).force;
  }

  /// Law for a given play.
  Step begin(double play) const { return begin(play, 0.0, 0.0); }

  /// Law after a step that ends at deformation s.
  Step next(const Step& step, double s) const;

  /// ψ (up to a constant), f and f' at s within a step; ψ is C1 and f its derivative.
  Point operator()(const Step& step, double s) const {
    if (!memory_ || s > step.high) return shifted(upper_(s), step.on_upper);
    if (s < step.low) return shifted(lower_(s), step.on_lower);
    const Point path = path_(s);
    return {path.potential + step.play * s, path.force + step.play, path.slope};
  }

  /// Energy that an element could give back: that of the loop's middle line, plus that of the
  /// reversal path as a spring in series with a slider. Work minus the change of this energy was
  /// dissipated.
  double stored(double play, double s) const;

 private:
  static Point shifted(Point point, double constant) {
    point.potential += constant;
    return point;
  }
  double clampPlay(double play, double s) const {
    const double path = path_(s).force;
    return std::clamp(play, std::min(lower_(s).force, upper_(s).force) - path, upper_(s).force - path);
  }
  Step begin(double play, double near_low, double near_high) const;
  std::vector<double> abovePath(const Curve& branch) const;
  double joins(const std::vector<double>& above_path, double play, double near) const;

  bool memory_ = false;
  double begin_ = 0.0, step_ = 1.0;
  int nodes_ = 0;
  Curve upper_, lower_, path_;
  std::vector<double> upper_above_, lower_above_;  ///< branches minus R at the nodes
};

}  // namespace haptic_cloth
