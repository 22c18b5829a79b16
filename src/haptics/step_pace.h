/// Wall-clock time from one step of the solver to the next.
#pragma once

#include <algorithm>

namespace haptic_cloth {

/// Smoothed mean of the time between the starts of steps. The solver's thread calls it.
class StepPace {
 public:
  /// @param time_step simulated time of a step [s]: no step is counted as shorter
  explicit StepPace(double time_step) : time_step_(time_step), seconds_(time_step) {}

  /// A step starts. @param now steady clock [s]
  void begin(double now) {
    if (last_start_ >= 0.0) seconds_ += kSmoothing * (now - last_start_ - seconds_);
    seconds_ = std::max(seconds_, time_step_);
    last_start_ = now;
  }

  /// The time until the next start is a pause and does not count.
  void interrupt() { last_start_ = -1.0; }

  double seconds() const { return seconds_; }  ///< [s]

 private:
  static constexpr double kSmoothing = 0.1;  ///< weight of the newest step [-]
  double time_step_;
  double seconds_;
  double last_start_ = -1.0;  ///< steady clock [s]; < 0: none since the start or a pause
};

}  // namespace haptic_cloth
