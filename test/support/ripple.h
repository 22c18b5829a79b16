/// Ripple of a force along a way.
#pragma once

#include <vector>

namespace haptic_cloth {

/// Largest deviation of y(x) from its polynomial fit, over the mean.
double ripple(const std::vector<double>& x, const std::vector<double>& y, int degree);

}  // namespace haptic_cloth
