/// The private parameters of the node: a scene and how to run it. Each default stands here only.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/scene.h"
#include "ros/device_map.h"

namespace haptic_cloth {

/// How one probe is served.
struct ProbeSettings {
  DeviceOptions device;
  HapticOptions haptics;  ///< limits at the device; coupling as in the scene
};

struct NodeOptions {
  std::string frame_id = "world";         ///< the cloth's frame, and that of all output
  std::string scene_file;                 ///< read first; scene parameters then override single values
  double max_pose_age = 0.2;              ///< a pose with an older stamp is dropped [s]; 0: never
  double probe_timeout = 1.0;             ///< without poses this long the probe leaves the scene [s]
  double velocity_time_constant = 0.005;  ///< low pass of the device's velocity [s]
  double step_budget = 0.025;         ///< wall clock of one solve, or the scene's if that is less [s]; the
                                      ///< force would time out while a hard step runs on; 0: none
  double markers_rate = 30.0;         ///< [Hz]
  double markers_force_scale = 0.05;  ///< length of the force arrow [m/N]
  double state_rate = 30.0;           ///< [Hz]
  DeviceOptions device;               ///< what holds for every probe's
  HapticOptions haptics;              ///< what holds for every probe
  Scene scene;
  std::vector<ProbeSettings> probes;  ///< in the scene's order
};

/// Reads the tree of private parameters: the keys of a scene file beside those of NodeOptions
/// (config/node.yaml shows them all).
/// @throws InputError for unknown keys, wrong types and impossible values
NodeOptions parseNodeOptions(const XmlRpc::XmlRpcValue& parameters, const std::string& origin);

}  // namespace haptic_cloth
