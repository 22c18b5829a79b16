/// Names and queue sizes of all topics and services, in one place. Relative names: remap at will.
#pragma once

#include <string>

namespace haptic_cloth {
namespace topics {

// Of a probe that has no name; those with names have the same below their own.
// Newest value only: an old pose or force is worth nothing.
constexpr char kPose[] = "probe/pose";
constexpr int kPoseQueue = 1;
constexpr char kReaction[] = "probe/reaction";
constexpr int kReactionQueue = 1;
// Of admittance devices.
constexpr char kForce[] = "probe/force";
constexpr int kForceQueue = 1;
constexpr char kCommand[] = "probe/command";
constexpr int kCommandQueue = 1;
constexpr char kProxy[] = "probe/proxy";
constexpr int kProxyQueue = 1;
constexpr char kGrasp[] = "probe/grasp";
constexpr int kGraspQueue = 10;
constexpr char kSetGrasp[] = "probe/set_grasp";  ///< service

/// One of the names above for the probe `name`.
inline std::string ofProbe(const std::string& name, const char* topic) {
  const std::string text = topic;
  return name + text.substr(text.find('/'));
}

/// Where an obstacle is sent.
inline std::string obstaclePose(const std::string& name) { return "obstacles/" + name + "/pose"; }

constexpr char kMarkers[] = "cloth/markers";
constexpr int kMarkersQueue = 1;
constexpr char kState[] = "cloth/state";
constexpr int kStateQueue = 1;

constexpr char kDiagnostics[] = "/diagnostics";
constexpr int kDiagnosticsQueue = 10;

// The adapter's side of the driver, of any type.
constexpr char kDevicePose[] = "device/pose";
constexpr char kDeviceForce[] = "device/force";

// Private services.
constexpr char kReset[] = "reset";
constexpr char kPause[] = "pause";
constexpr char kSaveState[] = "save_state";
constexpr char kLoadState[] = "load_state";

// Those of dynamic_reconfigure, private, by which its tools find them.
constexpr char kSetOptions[] = "set_parameters";  ///< service
constexpr char kOptionDescriptions[] = "parameter_descriptions";
constexpr char kOptionUpdates[] = "parameter_updates";

}  // namespace topics
}  // namespace haptic_cloth
