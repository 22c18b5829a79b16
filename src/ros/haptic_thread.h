/// The haptic thread: a wrench for every probe every millisecond, whatever the solver does.
#pragma once

#include <ros/publisher.h>

#include <string>
#include <vector>

#include "ros/haptic_probe.h"
#include "ros/node_options.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

class HapticThread {
 public:
  /// @param reactions one for each probe
  HapticThread(const NodeOptions& options, const std::vector<ros::Publisher>& reactions, SharedState& shared);

  /// Runs until shared.stop; then ramps down and sends zeros.
  void run();

  /// What requestRealTime() gave; empty before the thread has started.
  std::string scheduling() const { return scheduling_ready_ ? scheduling_ : ""; }

 private:
  void tick(double now, bool paused);
  bool isQuiet() const;
  void record(double now, double lateness);
  void endWithZeros();

  double period_;  ///< [s]
  SharedState& shared_;
  std::vector<HapticProbe> probes_;
  HapticStats window_;
  double window_start_ = -1.0;
  std::string scheduling_;
  std::atomic<bool> scheduling_ready_{false};
};

}  // namespace haptic_cloth
