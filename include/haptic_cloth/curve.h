/// A force law without history, tabulated: force, its integral and its slope.
#pragma once

#include <vector>

namespace haptic_cloth {

/// Force f(s) of a deformation s (strain [-], curvature [1/m] or shear angle [rad]) as a piecewise
/// linear function on equal intervals, continued linearly beyond both ends. Its integral ψ is C1
/// and ψ' = f exactly, so an energy built on it agrees with its gradient to round-off.
class Curve {
 public:
  struct Point {
    double potential;  ///< ψ(s) = ∫₀ˢ f  [f · s]
    double force;      ///< f(s)
    double slope;      ///< f'(s), that of the interval that contains s
  };

  /// f = 0: no law.
  Curve() : Curve(0.0, 1.0, {0.0, 0.0}) {}

  /// @param begin  s of the first sample
  /// @param step   distance of samples, > 0
  /// @param forces f at begin, begin + step, ...; at least two samples
  /// @throws InputError if one of these rules is broken
  Curve(double begin, double step, const std::vector<double>& forces);

  /// f = slope · s.
  static Curve linear(double slope) { return Curve(0.0, 1.0, {0.0, slope}); }

  Point operator()(double s) const {
    const double t = (s - begin_) * inverse_step_;
    const double last = static_cast<double>(intervals_.size() - 1);
    const Interval& interval = intervals_[static_cast<std::size_t>(t > 0.0 ? (t < last ? t : last) : 0.0)];
    const double ds = s - interval.begin;
    return {interval.potential + ds * (interval.force + 0.5 * ds * interval.slope),
            interval.force + ds * interval.slope, interval.slope};
  }

  /// Coefficients of f from `begin` to the next interval's; the outer intervals extend beyond the
  /// ends.
  struct Interval {
    double begin, potential, force, slope;
  };
  const std::vector<Interval>& intervals() const { return intervals_; }
  double begin() const { return begin_; }
  double inverseStep() const { return inverse_step_; }

  /// Tells whether f vanishes everywhere, so that a model can leave the term out.
  bool isZero() const;

 private:
  double begin_;
  double inverse_step_;
  std::vector<Interval> intervals_;
};

}  // namespace haptic_cloth
