#include "ros/programs/mouse_hand.h"

#include <array>
#include <cmath>
#include <utility>

#include "ros/display/solid_markers.h"
#include "ros/node/conversions.h"
#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;

/// Size of a handle over that of its probe, so that it is visible [-].
constexpr double kHandleSize = 1.3;
constexpr double kArrowLength = 5.0;  ///< length of an axis over the probe's radius [-]
constexpr double kHeight = 0.05;      ///< height of a waiting probe above the cloth [m]
constexpr double kApart = 4.0;        ///< distance of two waiting probes over the radius [-]

/// A control whose local x axis is `axis`.
InteractiveMarkerControl axisControl(const std::string& name, const Vec3& axis, int mode) {
  InteractiveMarkerControl control;
  control.name = name;
  control.orientation = toPose(Vec3::Zero(), Quat::FromTwoVectors(Vec3::UnitX(), axis)).orientation;
  control.interaction_mode = static_cast<InteractiveMarkerControl::_interaction_mode_type>(mode);
  return control;
}

}  // namespace

const Pose& SmoothedPose::step(const Pose& target, double dt) {
  const double part = -std::expm1(-dt / time_constant_);
  pose_.position += part * (target.position - pose_.position);
  pose_.orientation = pose_.orientation.slerp(part, target.orientation).normalized();
  return pose_;
}

Pose waitingPose(const Scene& scene, std::size_t number) {
  const ProbeOptions& probe = scene.probes[number];
  if (!probe.path.empty()) return {probe.path.front().position, probe.orientation};
  const double place = static_cast<double>(number) - 0.5 * static_cast<double>(scene.probes.size() - 1);
  return {scene.cloth.pose.position + Vec3(place * kApart * probe.radius, 0.0, kHeight), probe.orientation};
}

InteractiveMarker probeHandle(const ProbeOptions& probe, const Pose& pose, const std::string& frame_id) {
  InteractiveMarker handle;
  handle.header.frame_id = frame_id;
  handle.name = probe.name;
  handle.description = probe.name;
  handle.pose = toPose(pose);
  handle.scale = static_cast<float>(kArrowLength * probe.radius + probe.length);

  InteractiveMarkerControl ball;
  ball.name = "drag";
  ball.always_visible = true;
  ball.orientation.w = 1.0;
  ball.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  Obstacle solid = solidOf(probe);
  solid.radius *= kHandleSize;
  visualization_msgs::MarkerArray array;
  const SolidMarkers markers(array, probe.name, solid, markerColor(0.9F, 0.9F, 0.2F, 0.35F), "");
  ball.markers = array.markers;
  handle.controls.push_back(ball);

  const std::array<std::pair<const char*, Vec3>, 3> axes{std::pair("x", Vec3(Vec3::UnitX())),
                                                         std::pair("y", Vec3(Vec3::UnitY())),
                                                         std::pair("z", Vec3(Vec3::UnitZ()))};
  for (const auto& [name, axis] : axes) {
    handle.controls.push_back(
        axisControl(std::string("move ") + name, axis, InteractiveMarkerControl::MOVE_AXIS));
    if (probe.length == 0.0) continue;
    handle.controls.push_back(
        axisControl(std::string("turn ") + name, axis, InteractiveMarkerControl::ROTATE_AXIS));
  }
  return handle;
}

}  // namespace haptic_cloth
