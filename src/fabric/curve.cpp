#include "haptic_cloth/curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haptic_cloth {

Curve::Curve(double begin, double step, const std::vector<double>& forces)
    : begin_(begin), inverse_step_(1.0 / step) {
  assert(step > 0.0 && forces.size() >= 2);
  // A node that is meant to lie at zero is put there exactly, so that f(0) = 0 without rounding
  // error.
  double first = begin / step;
  if (std::abs(first - std::round(first)) < 1e-6) first = std::round(first);

  intervals_.resize(forces.size() - 1);
  double potential = 0.0;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const double rise = forces[i + 1] - forces[i];
    intervals_[i] = {(first + static_cast<double>(i)) * step, potential, forces[i], rise / step};
    potential += 0.5 * step * (forces[i] + forces[i + 1]);
  }
  const double at_zero = (*this)(0.0).potential;
  for (Interval& interval : intervals_) interval.potential -= at_zero;
}

bool Curve::isZero() const {
  return std::all_of(intervals_.begin(), intervals_.end(),
                     [](const Interval& interval) { return interval.force == 0.0 && interval.slope == 0.0; });
}

}  // namespace haptic_cloth
