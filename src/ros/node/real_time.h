/// Real-time priority for the threads between device and hand. All other threads are scheduled
/// normally.
#pragma once

#include <ros/callback_queue.h>

#include <string>

namespace haptic_cloth {

/// Requests real-time scheduling for the calling thread and locked memory for the process.
/// @return the result as text: "SCHED_FIFO 80, memory locked", or the reason of a failure
std::string requestRealTime();

/// Requests real-time scheduling, below the haptic thread, for roscpp's network thread and for the
/// thread that serves `poses`. A force computed in time must also leave the process in time, and
/// poses must come in. Call it once, before `poses` is served.
void prioritiseMessages(ros::CallbackQueue& poses);

}  // namespace haptic_cloth
