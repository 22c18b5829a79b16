/// Snapshots of one probe from the steps of the solver.
#pragma once

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/report.h"

namespace haptic_cloth {

/// Learns how one probe's proxy follows its device, by secants of successive solves, so it costs the solver
/// nothing: Powell's symmetric form of Broyden's update [Powell 1970]. Eigenvalues are kept in 0..1, as those
/// of the derivative of an elastic equilibrium through a spring are: (k + S)⁻¹ k, S the cloth's stiffness at
/// the proxy.
class ProbeTracker {
 public:
  /// Makes the snapshot after a step.
  /// @param device pose for which the step was solved  @param step_interval wall-clock time of a step [s]
  /// @param taken see ProbeSnapshot
  ProbeSnapshot update(const ProbeReport& probe, const DeviceSample& device, double step_interval,
                       double taken);

  /// Forgets what was learned.
  void reset() { *this = ProbeTracker(); }

  const Mat6& follow() const { return follow_; }

 private:
  double trustIn(const ProbeReport& probe, double step_interval);
  void forgetTurns();
  void learn(const Vec6& device_moved, const Vec6& proxy_moved);

  Mat6 follow_ = Mat6::Identity();  ///< until more is known nothing resists
  Vec6 drift_ = Vec6::Zero();       ///< smoothed [m/s]
  double error_ = 0.0;              ///< estimated, of the force, now or lately [N]
  bool known_ = false;              ///< there was a last step
  ProbeSnapshot last_;              ///< of it
};

}  // namespace haptic_cloth
