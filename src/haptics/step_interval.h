/// Wall-clock time from one step of the solver to the next.
#pragma once

#include <algorithm>

namespace haptic_cloth {

/// Wall-clock time of the current step: its simulated time, times a smoothed mean of wall-clock over
/// simulated time. The solver's thread calls it.
class StepInterval {
 public:
  /// A step starts.
  /// @param now steady clock [s]
  /// @param time_step simulated time of the step [s]: no step is counted as shorter
  /// @param pause longer times between two starts do not count [s]
  /// @return whether the step is the first since the start or a pause
  bool begin(double now, double time_step, double pause) {
    const bool first = !(now - last_start_ <= pause);
    if (!first) {
      const double newest = (now - last_start_) / time_step_;
      slowness_ += kSmoothing * (newest - slowness_);
      steady_ = std::max(1.0, std::min(newest, newest_));
      newest_ = newest;
    }
    slowness_ = std::max(slowness_, 1.0);
    time_step_ = time_step;
    last_start_ = now;
    return first;
  }

  /// The time until the next start is a pause and does not count.
  void interrupt() { last_start_ = -1e30; }

  double seconds() const { return slowness_ * time_step_; }  ///< [s]; 0 before the first step

  /// The same as seconds(), with the lesser slowness of the last two steps instead of the mean: one late
  /// step does not count [s].
  double steadySeconds() const { return steady_ * time_step_; }

 private:
  static constexpr double kSmoothing = 0.1;  ///< weight of the newest step [-]
  double slowness_ = 1.0;                    ///< wall-clock over simulated time [-]
  double newest_ = 1.0, steady_ = 1.0;       ///< the same of the last step, and the lesser of the last two
  double time_step_ = 0.0;                   ///< of the current step [s]
  double last_start_ = -1e30;                ///< steady clock [s]; long ago: none since the start or a pause
};

}  // namespace haptic_cloth
