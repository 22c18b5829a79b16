/// Content of /diagnostics (REP-107). Pure functions. Names are those of the parts, without the
/// node's name.
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

/// Counters of what a device sends.
struct DeviceCounters {
  const InputCounters& poses;
  const InputCounters* forces = nullptr;  ///< of admittance devices alone
};

/// Status of one probe: messages of its device, force and grasp. A dropped message is a warning for
/// at most 5 s.
/// @param force_error estimated error of the force on the hand [N]
/// @param others other nodes that publish to the device; empty: none
diagnostic_msgs::DiagnosticStatus probeStatus(const std::string& name, const DeviceCounters& counters,
                                              const FeltForce& felt, GraspState grasp, double force_error,
                                              double now, const std::string& others = "");

/// Status of one obstacle that can be moved. A dropped pose, and a quaternion that should have turned it, is
/// a warning for 5 s. An obstacle without new poses stands still, which is no fault.
diagnostic_msgs::DiagnosticStatus obstacleStatus(const std::string& name, const DropCounters& counters,
                                                 double now);

/// @param scheduling as returned by requestRealTime()
diagnostic_msgs::DiagnosticStatus hapticStatus(const HapticStats& stats, const std::string& scheduling,
                                               double now);

/// Status of the live changes of options.
diagnostic_msgs::DiagnosticStatus optionsStatus(const LiveReport& report);

/// @param registrations see MasterWatch::renewals()
diagnostic_msgs::DiagnosticStatus displayStatus(std::uint64_t marker_frames, std::uint64_t state_frames,
                                                bool master_reachable, std::uint64_t registrations);

}  // namespace haptic_cloth
