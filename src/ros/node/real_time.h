/// Priority for what lies between the device and the hand. The rest of the node is scheduled as any program.
#pragma once

#include <ros/callback_queue.h>

#include <string>

namespace haptic_cloth {

/// Asks for real-time scheduling and locked memory for the calling thread and process.
/// @return what was got, in words for people: "SCHED_FIFO 80, memory locked", or why not
std::string requestRealTime();

/// Asks for real-time scheduling, below the haptic thread, of roscpp's network thread and of the one that
/// calls `poses`: a force that was computed in time must also leave the process in time, and poses must come
/// in. To be called once, before `poses` is served.
void prioritiseMessages(ros::CallbackQueue& poses);

}  // namespace haptic_cloth
