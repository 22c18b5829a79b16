/// Steps that would change nothing.
#pragma once

#include <vector>

#include "contact/contact_set.h"
#include "haptic_cloth/report.h"
#include "sim/probes.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Tells when steps may be skipped: all particles have slept for a while, and no input differs from
/// that of the last solved step.
class IdleTracker {
 public:
  explicit IdleTracker(int probes) : count_(probes) { probes_.reserve(probes); }

  /// Tells whether the next step would change nothing.
  bool isIdle(const Probes& probes, const ContactSet& contacts) const;

  /// Records a solved step.
  /// @param sleep_speed proxies slower than this rest [m/s]
  /// @param adapts number of steps in which the mesh has had time to adapt
  void note(const StepReport& report, const Probes& probes, double sleep_speed, int adapts);

  /// Makes the next steps be solved, after a change that the inputs do not show.
  void forget();

  /// Report of a skipped step, without time and particles: residual and contacts of the last solved step.
  const StepReport& skipped() const { return skipped_; }

  void serialize(Archive& archive);

 private:
  bool devicesStay(const Probes& probes) const;

  int count_;      ///< number of probes
  int quiet_ = 0;  ///< steps in a row in which all slept and no input changed; no more count than are enough
  bool idle_ = false;              ///< quiet_ is large enough
  std::vector<ProbeStep> probes_;  ///< in the last solved step; empty before it
  StepReport skipped_;
};

}  // namespace haptic_cloth
