/// Keeps simulated time at wall time: length and quality of each step.
#pragma once

#include <vector>

namespace haptic_cloth {

/// Plans the steps of a solver. It has no clock of its own: its caller says when steps start and end.
///
/// Length: a step is as long as simulated time lags behind, up to the limit of the rung in use or half of the
/// step before. From step to step it changes by at most a factor of two.
///
/// Rung (qualityLadder()): down by one if the longest steps do not catch up within 30 ms. By two, to a rung
/// that costs the force little, if simulated time went less than half as fast as wall time in more than one
/// step, unless the rung in use is only being tried. Up by one if steps as long as the better rung's would
/// take less than half of the time at the present rung, for 0.5 s. Up also if for as long no step used up the
/// iterations that the rung grants and the better rung's steps may be as long: more iterations cost nothing
/// then. If the better rung proves too slow, the next attempt waits twice as long, up to 30 s.
///
/// Lag beyond kLongestLag is given up: simulated time slips.
class ClockKeeper {
 public:
  static constexpr double kLongestLag = 0.1;  ///< what is more is given up [s]

  /// @param time_step unit of the steps' lengths [s]
  explicit ClockKeeper(double time_step) : h_(time_step) { setRungs({1}, 1); }

  /// Sets the longest step of each rung, in time steps; the first rung is the best. The rung in use stays, or
  /// becomes the last one. Failed attempts are forgotten.
  /// @param gentle number of the first rungs, which cost the force little: only these may be skipped. Those
  ///   after them limit the iterations or have longer steps, and are else like the last of these
  void setRungs(const std::vector<int>& longest_steps, int gentle);

  /// Wall time before which the next step must not start [s]. @param now [s]
  double due(double now) const { return isDue(now) ? now : due_; }

  struct Step {
    int length;  ///< in time steps
    int rung;    ///< 0: the best
  };

  /// A step starts. @param now wall time, not before due() [s]; that of the last step is taken if it is not
  /// finite
  Step begin(double now);

  /// The step that was begun ends.
  /// @param now wall time [s]
  /// @param cut the rung's limit of iterations ended its solve
  void end(double now, bool cut);

  /// Forgets the lag, as after a pause: the next step is due at once.
  void restart();

  double slipped() const { return slipped_; }  ///< lag given up so far [s]

 private:
  /// Tells whether nothing says when the next step is due: the first one, and after a clock was set back.
  bool isDue(double now) const { return due_ < 0.0 || due_ > now + kLongestLag + length_ * h_; }
  void chooseRung(double lag, double now);
  void fall(double now);
  void rise(double now);

  double h_;
  std::vector<int> longest_;
  int gentle_ = 1;             ///< number of the first rungs that may be skipped
  std::vector<double> waits_;  ///< time for which there must be room before a rise to each rung [s]
  int rung_ = 0, length_ = 1;
  double due_ = -1.0;  ///< wall time at which simulated time is reached [s]; < 0: unknown
  double slipped_ = 0.0;

  double begun_ = 0.0;  ///< start of the current step [s]
  double load_ = 1.0;   ///< time that steps of one time step take over their length, smoothed [-]

  bool behind_ = false;        ///< a step of the longest length would not catch up
  double behind_since_ = 0.0;  ///< start of an interval in which that is so [s]
  double behind_by_ = 0.0;     ///< lag at that time and what had slipped [s]
  int behind_steps_ = 0;       ///< steps since that time
  bool cut_ = false;           ///< the last step used up its iterations
  bool roomy_ = false;         ///< there is room for a better rung
  double roomy_since_ = 0.0;   ///< [s]
  bool risen_ = false;         ///< the last change was a rise, whose success is not known
  double risen_at_ = 0.0;      ///< [s]
};

}  // namespace haptic_cloth
