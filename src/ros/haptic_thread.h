/// The haptic thread: a wrench every millisecond, whatever the solver does.
#pragma once

#include <ros/publisher.h>

#include <string>

#include "ros/node_options.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

/// Asks for real-time scheduling and locked memory for the calling thread and process.
/// @return what was got, in words for people: "SCHED_FIFO 80, memory locked", or why not
std::string requestRealTime();

class HapticThread {
 public:
  HapticThread(const NodeOptions& options, const ros::Publisher& reaction, SharedState& shared);

  /// Runs until shared.stop; then ramps down and sends zeros.
  void run();

  /// What requestRealTime() gave; empty before the thread has started.
  std::string scheduling() const { return scheduling_ready_ ? scheduling_ : ""; }

 private:
  void tick(double now, bool paused);
  /// Sends the force in the frame, axes and scale of the pose it answers.
  void publish(const Vec3& force, const StampedSample& device);
  void record(double now, double lateness);
  void endWithZeros();

  std::string frame_id_;
  DeviceOptions device_;
  double period_;  ///< [s]
  ros::Publisher reaction_;
  SharedState& shared_;
  HapticLoop loop_;
  Vec3 force_ = Vec3::Zero();  ///< last sent, on the probe in the cloth's frame [N]
  HapticStats window_;
  double window_start_ = -1.0;
  std::string scheduling_;
  std::atomic<bool> scheduling_ready_{false};
};

}  // namespace haptic_cloth
