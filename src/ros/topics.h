/// Names and queue sizes of all topics and services, in one place. Relative names: remap at will.
#pragma once

namespace haptic_cloth {
namespace topics {

// Newest value only: an old pose or force is worth nothing.
constexpr char kPose[] = "probe/pose";
constexpr int kPoseQueue = 1;
constexpr char kReaction[] = "probe/reaction";
constexpr int kReactionQueue = 1;

constexpr char kProxy[] = "probe/proxy";
constexpr int kProxyQueue = 1;
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

}  // namespace topics
}  // namespace haptic_cloth
