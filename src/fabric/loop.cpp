#include "haptic_cloth/loop.h"

#include <cmath>
#include <string>

#include "haptic_cloth/error.h"

namespace haptic_cloth {

Loop::Loop(double begin, double step, std::vector<double> upper, std::vector<double> lower, double reversal,
           double longest_crossing) {
  if (!(reversal > 1.0)) throw InputError("loop", "reversal", std::to_string(reversal), "must be > 1");
  if (!(longest_crossing > 0.0))
    throw InputError("loop", "longest_crossing", std::to_string(longest_crossing), "must be > 0");
  if (upper.size() != lower.size() || upper.size() < 2) {
    throw InputError("loop", "upper, lower",
                     std::to_string(upper.size()) + " and " + std::to_string(lower.size()) + " samples",
                     "must be as many, and at least two");
  }
  const double rounding = 1e-9 * (std::abs(upper.back()) + std::abs(lower.front()));
  for (std::size_t i = 0; i < upper.size(); ++i) {
    if (lower[i] > upper[i] + rounding)
      throw InputError("loop", "lower", std::to_string(lower[i]) + " in sample " + std::to_string(i),
                       "must not be above upper, " + std::to_string(upper[i]));
  }
  // One more interval at each end. There, and so beyond the ends, both branches rise alike: at the
  // upper end like the upper branch, at the lower end like the lower. So an odd loop is odd beyond
  // its ends, too.
  const double first = lower[1] - lower[0], last = upper.back() - upper[upper.size() - 2];
  for (auto* branch : {&upper, &lower}) {
    branch->insert(branch->begin(), branch->front() - first);
    branch->push_back(branch->back() + last);
  }
  begin_ = begin - step;
  step_ = step;
  nodes_ = static_cast<int>(upper.size());

  double largest = 0.0, widest = 0.0;
  std::vector<double> rises;  // of the steeper branch
  for (int i = 0; i + 1 < nodes_; ++i) {
    rises.push_back(std::max({upper[i + 1] - upper[i], lower[i + 1] - lower[i], 0.0}));
    largest = std::max(largest, rises[i]);
    widest = std::max({widest, upper[i] - lower[i], upper[i + 1] - lower[i + 1]});
  }
  memory_ = widest > 1e-12 * largest;
  upper_ = Curve(begin_, step, upper);
  if (!memory_) return;
  std::vector<double> path{0.0};
  for (const double rise : rises) {
    path.push_back(path.back() + std::max(reversal * rise, rise + widest * step / longest_crossing));
  }
  // Without a longest crossing the path has to rise, too, where both branches are level.
  for (int i = 0; i < nodes_; ++i) path[i] += 1e-6 * largest * i;
  const double at_zero = Curve(begin_, step, path)(0.0).force;
  for (double& force : path) force -= at_zero;
  lower_ = Curve(begin_, step, lower);
  path_ = Curve(begin_, step, path);
  upper_above_ = abovePath(upper_);
  lower_above_ = abovePath(lower_);
}

/// branch - R at the nodes.
std::vector<double> Loop::abovePath(const Curve& branch) const {
  std::vector<double> above(nodes_);
  for (int node = 0; node < nodes_; ++node) {
    const double s = begin_ + node * step_;
    above[node] = branch(s).force - path_(s).force;
  }
  return above;
}

/// Finds the deformation at which branch - R, which falls everywhere, equals the play. It walks
/// among the nodes from a likely one in doubling strides, bisects between the last two, then takes
/// the root of a line. Beyond the ends the lines of the last intervals continue.
double Loop::joins(const std::vector<double>& above_path, double play, double near) const {
  const auto above = [&](int node) { return above_path[node] - play; };
  const int last = nodes_ - 1;
  int low = static_cast<int>(std::clamp((near - begin_) / step_, 0.0, last - 1.0));
  int high = low + 1;
  for (int stride = 1; low > 0 && !(above(low) > 0.0); stride *= 2) {
    high = low;
    low = std::max(0, low - stride);
  }
  for (int stride = 1; high < last && above(high) > 0.0; stride *= 2) {
    low = high;
    high = std::min(last, high + stride);
  }
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (above(middle) > 0.0 ? low : high) = middle;
  }
  const double a = above(low), b = above(high);
  return begin_ + (low + a / (a - b) * (high - low)) * step_;
}

Loop::Step Loop::begin(double play, double near_low, double near_high) const {
  if (!memory_) return {};
  Step step{play, joins(lower_above_, play, near_low), joins(upper_above_, play, near_high), 0.0, 0.0};
  const auto onPath = [&](double s) { return path_(s).potential + play * s; };
  step.on_lower = onPath(step.low) - lower_(step.low).potential;
  step.on_upper = onPath(step.high) - upper_(step.high).potential;
  return step;
}

Loop::Step Loop::next(const Step& step, double s) const {
  if (!memory_ || (s >= step.low && s <= step.high)) return step;
  return begin(commit(step.play, s), step.low, step.high);
}

double Loop::stored(double play, double s) const {
  if (!memory_) return upper_(s).potential;
  const Point up = upper_(s), low = lower_(s), path = path_(s);
  const double slider = path.force + clampPlay(play, s) - 0.5 * (up.force + low.force);
  const double spring = path.slope - 0.5 * (up.slope + low.slope);
  return 0.5 * (up.potential + low.potential) + 0.5 * slider * slider / spring;
}

}  // namespace haptic_cloth
