/// Gains that move to new values instead of jumping there.
#pragma once

namespace haptic_cloth {

/// Gains that scale the force of one probe.
struct Gains {
  double coupling_stiffness = 0.0;  ///< [N/m]
  double coupling_damping = 0.0;    ///< [N·s/m]
  double force_scale = 1.0;         ///< force on the hand per force on the probe [-]
  bool operator!=(const Gains& other) const {
    return coupling_stiffness != other.coupling_stiffness || coupling_damping != other.coupling_damping ||
           force_scale != other.force_scale;
  }
};

/// Straight line in time from one set of gains to the next. The thread of the device follows it, and a
/// session passes the coupling on to the solver.
class GainRamp {
 public:
  GainRamp() = default;
  explicit GainRamp(const Gains& gains) : from_(gains), to_(gains) {}

  /// Ramp from the gains at `now` to `gains`. @param time until they are reached [s]; 0: at once
  GainRamp onTo(const Gains& gains, double now, double time) const;

  Gains at(double now) const;
  bool isDone(double now) const { return now >= start_ + time_; }

 private:
  Gains from_, to_;
  double start_ = 0.0;  ///< steady clock [s]
  double time_ = 0.0;   ///< [s]
};

}  // namespace haptic_cloth
