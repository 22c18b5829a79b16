/// The haptic thread: a wrench for every probe every millisecond, whatever the solver does.
#pragma once

#include <ros/publisher.h>

#include <memory>
#include <string>
#include <vector>

#include "ros/haptic/probe_tick.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Output of one probe.
struct ProbePublishers {
  ros::Publisher reaction;
  ros::Publisher command;  ///< of admittance devices alone
};

class HapticThread {
 public:
  /// @param publishers one for each probe
  HapticThread(const NodeOptions& options, const std::vector<ProbePublishers>& publishers,
               SharedState& shared);

  /// Runs until shared.stop; then ramps down and sends zeros.
  void run();

  /// Result of requestRealTime(); empty before the thread has started.
  std::string scheduling() const { return scheduling_ready_ ? scheduling_ : ""; }

 private:
  void takeOptions();
  void tick(double now, bool paused);
  double heard(double now) const;
  bool isQuiet() const;
  void record(double now, double lateness);
  void endAtRest();

  double period_;  ///< [s]
  SharedState& shared_;
  LiveReader live_;
  std::vector<std::unique_ptr<ProbeTick>> probes_;
  HapticStats window_;
  double window_start_ = -1.0;
  std::string scheduling_;
  std::atomic<bool> scheduling_ready_{false};
};

}  // namespace haptic_cloth
