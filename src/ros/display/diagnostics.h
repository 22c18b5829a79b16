/// What /diagnostics says (REP-107). Pure functions; names are those of the parts, without the
/// node's.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cstdint>
#include <string>

#include "ros/input/device_input.h"
#include "ros/input/obstacle_input.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// @param now steady clock [s]; statistics older than 2 s mean that the thread hangs
diagnostic_msgs::DiagnosticStatus solverStatus(const SolverStats& stats, bool paused, double now);

/// One probe: what its device sends, what it feels, what it holds. A dropped message is a warning for 5 s.
/// @param message what the device sends: "pose" or "force"
diagnostic_msgs::DiagnosticStatus probeStatus(const std::string& name, const InputCounters& counters,
                                              const FeltForce& felt, GraspState grasp, double now,
                                              const std::string& message = "pose");

/// One obstacle that can be moved. A dropped pose is a warning for 5 s.
diagnostic_msgs::DiagnosticStatus obstacleStatus(const std::string& name, const ObstacleCounters& counters,
                                                 double now);

/// @param scheduling as given by requestRealTime()
diagnostic_msgs::DiagnosticStatus hapticStatus(const HapticStats& stats, const std::string& scheduling,
                                               double now);

/// Live changes of options.
diagnostic_msgs::DiagnosticStatus optionsStatus(const LiveReport& report);

/// @param registrations renewed after the master was lost
diagnostic_msgs::DiagnosticStatus displayStatus(std::uint64_t marker_frames, std::uint64_t state_frames,
                                                bool master_reachable, std::uint64_t registrations);

}  // namespace haptic_cloth
