/// A force law with hysteresis: play between the two branches of a measured loop.
#pragma once

#include <algorithm>
#include <vector>

#include "haptic_cloth/curve.h"

namespace haptic_cloth {

/// Force of a deformation s (strain [-], curvature [1/m] or shear angle [rad]) with memory:
///
///     f(s) = R(s) + clamp(q, lower(s) - R(s), upper(s) - R(s)),
///
/// upper and lower the branches of the outer loop, R the path taken after a reversal and q, the play, the one
/// number an element remembers. R rises faster than both branches everywhere (`reversal` times the steeper),
/// so a path leaves one branch, runs along R and joins the other: inner cycles stay inside the loop, close,
/// dissipate and do not ratchet (play operator [Visintin 1994, III.2]). Where both branches are one, the law
/// is elastic there; where they are one everywhere, it has no memory at all.
class Loop {
 public:
  using Point = Curve::Point;

  /// The law of one element until its play changes: the path in the middle, the branches beyond.
  struct Step {
    double play;                ///< q
    double low, high;           ///< deformations at which the path joins the lower and the upper branch
    double on_lower, on_upper;  ///< constants by which the branches' integrals continue the path's
  };

  /// f = 0.
  Loop() : Loop(Curve()) {}

  /// Without memory.
  Loop(const Curve& elastic) : upper_(elastic) {}  // NOLINT: an elastic law is a loop

  /// @param upper, lower branches on one grid begin, begin + step, ...; upper >= lower, both non-decreasing;
  /// past the ends both go on with the upper's last slope and the lower's first
  /// @param reversal slope of R over that of the steeper branch, > 1
  Loop(double begin, double step, std::vector<double> upper, std::vector<double> lower, double reversal);

  bool hasMemory() const { return memory_; }
  bool isZero() const { return !memory_ && upper_.isZero(); }

  /// The rising branch; the law itself where there is no memory.
  const Curve& upper() const { return upper_; }

  /// The falling branch.
  const Curve& lower() const { return memory_ ? lower_ : upper_; }

  /// R. @pre hasMemory()
  const Curve& path() const { return path_; }

  /// Play of an element that was never deformed.
  double initialPlay() const { return memory_ ? clampPlay(0.0, 0.0) : 0.0; }

  /// Play after a step that ends at deformation s.
  double commit(double play, double s) const { return memory_ ? clampPlay(play, s) : 0.0; }

  /// Play that gives `force` at s, or the nearest the loop allows: what a change of the mesh hands over.
  double playFor(double force, double s) const {
    return memory_ ? clampPlay(force - path_(s).force, s) : 0.0;
  }

  /// Force at s after commit(play, s).
  double force(double play, double s) const {
    return memory_ ? path_(s).force + clampPlay(play, s) : upper_(s).force;
  }

  /// The law for a given play.
  Step begin(double play) const { return begin(play, 0.0, 0.0); }

  /// The law after a step that ends at deformation s.
  Step next(const Step& step, double s) const;

  /// ψ (up to a constant), f and f' at s within a step; ψ is C1 and f its derivative.
  Point operator()(const Step& step, double s) const {
    if (!memory_ || s > step.high) return shifted(upper_(s), step.on_upper);
    if (s < step.low) return shifted(lower_(s), step.on_lower);
    const Point path = path_(s);
    return {path.potential + step.play * s, path.force + step.play, path.slope};
  }

  /// Energy an element could give back: that of the loop's middle line, and that of the reversal path as a
  /// spring in series with a slider. Work done minus its change is what was dissipated.
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
  std::vector<double> upper_above_, lower_above_;  ///< the branches less R at the nodes
};

}  // namespace haptic_cloth
