#include "haptic_cloth/curve.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "haptic_cloth/error.h"

namespace haptic_cloth {

Curve::Curve(double begin, double step, const std::vector<double>& forces)
    : begin_(begin), inverse_step_(1.0 / step) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!finite(begin) || !finite(step) || !std::all_of(forces.begin(), forces.end(), finite))
    throw InputError("curve", "begin, step, forces", "", "must be finite");
  if (!(step > 0.0)) throw InputError("curve", "step", std::to_string(step), "must be > 0");
  if (forces.size() < 2)
    throw InputError("curve", "forces", std::to_string(forces.size()) + " samples", "must be at least two");
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
