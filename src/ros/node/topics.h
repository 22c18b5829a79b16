/// Names and queue sizes of all topics and services. Names are relative, so they can be remapped.
#pragma once

#include <string>

namespace haptic_cloth {
namespace topics {

// Topics of the unnamed probe; a named probe has the same below its name. The queue holds only the
// newest value, because an old pose or force is useless.
constexpr char kPose[] = "probe/pose";
constexpr int kPoseQueue = 1;
constexpr char kReaction[] = "probe/reaction";
constexpr int kReactionQueue = 1;
// Topics of admittance devices.
constexpr char kForce[] = "probe/force";
constexpr int kForceQueue = 1;
constexpr char kCommand[] = "probe/command";
constexpr int kCommandQueue = 1;
constexpr char kProxy[] = "probe/proxy";
constexpr int kProxyQueue = 1;
constexpr char kGrasp[] = "probe/grasp";
constexpr int kGraspQueue = 10;
constexpr char kSetGrasp[] = "probe/set_grasp";  ///< service

/// Name of a topic or service above for the probe `name`.
inline std::string ofProbe(const std::string& name, const char* topic) {
  const std::string text = topic;
  return name + text.substr(text.find('/'));
}

/// Topic that moves an obstacle.
inline std::string obstaclePose(const std::string& name) { return "obstacles/" + name + "/pose"; }

constexpr char kMarkers[] = "cloth/markers";
constexpr int kMarkersQueue = 1;
constexpr char kState[] = "cloth/state";
constexpr int kStateQueue = 1;

constexpr char kDiagnostics[] = "/diagnostics";
constexpr int kDiagnosticsQueue = 10;

// Topics between adapter or button and driver, of the types in driver_messages.h.
constexpr char kDevicePose[] = "device/pose";
constexpr char kDeviceForce[] = "device/force";
constexpr char kDeviceButton[] = "device/button";
constexpr int kDeviceButtonQueue = 10;

// Private services.
constexpr char kReset[] = "reset";
constexpr char kPause[] = "pause";
constexpr char kSaveState[] = "save_state";
constexpr char kLoadState[] = "load_state";

// Private services and topics of dynamic_reconfigure, by which its tools find the node.
constexpr char kSetOptions[] = "set_parameters";  ///< service
constexpr char kOptionDescriptions[] = "parameter_descriptions";
constexpr char kOptionUpdates[] = "parameter_updates";

}  // namespace topics
}  // namespace haptic_cloth
