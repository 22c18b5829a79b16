#include "ros/display/solid_markers.h"

#include "ros/node/conversions.h"

namespace haptic_cloth {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kPlaneSide = 2.0;     ///< side length of the drawn part of a plane [m]
constexpr double kPlaneDepth = 0.002;  ///< [m]
constexpr double kNothing = 1e-6;      ///< size of a hidden marker [m]

}  // namespace

std_msgs::ColorRGBA markerColor(float r, float g, float b, float a) {
  std_msgs::ColorRGBA color;
  color.r = r;
  color.g = g;
  color.b = b;
  color.a = a;
  return color;
}

void setScale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

Marker& addMarker(MarkerArray& array, const std::string& name, int type, const std::string& frame_id) {
  Marker marker;
  marker.header.frame_id = frame_id;
  marker.ns = name;
  marker.id = static_cast<int>(array.markers.size());
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  setScale(marker, 1.0, 1.0, 1.0);
  marker.color = markerColor(1.0F, 1.0F, 1.0F);
  array.markers.push_back(marker);
  return array.markers.back();
}

SolidMarkers::SolidMarkers(MarkerArray& array, const std::string& name, const Obstacle& solid,
                           const std_msgs::ColorRGBA& color, const std::string& frame_id) {
  const auto part = [&](int type, const Vec3& offset, const Vec3& size) {
    parts_.push_back({array.markers.size(), offset, size});
    addMarker(array, name, type, frame_id).color = color;
  };
  const double diameter = 2.0 * solid.radius;
  const Vec3 ball = Vec3::Constant(diameter), tube(diameter, diameter, solid.length);
  switch (solid.shape) {
    case Shape::Box:
      part(Marker::CUBE, Vec3::Zero(), solid.size);
      break;
    case Shape::Sphere:
      part(Marker::SPHERE, Vec3::Zero(), ball);
      break;
    case Shape::Cylinder:
      part(Marker::CYLINDER, Vec3::Zero(), tube);
      break;
    case Shape::Capsule:
      part(Marker::CYLINDER, Vec3::Zero(), tube);
      for (const double side : {-0.5, 0.5}) part(Marker::SPHERE, side * solid.length * Vec3::UnitZ(), ball);
      break;
    case Shape::Plane:
      part(Marker::CUBE, -0.5 * kPlaneDepth * Vec3::UnitZ(), Vec3(kPlaneSide, kPlaneSide, kPlaneDepth));
      break;
  }
  place(array, solid.pose);
  show(array, true);
}

void SolidMarkers::place(MarkerArray& array, const Pose& pose) const {
  for (const Part& part : parts_) {
    array.markers[part.marker].pose =
        toPose(pose.position + pose.orientation * part.offset, pose.orientation);
  }
}

void SolidMarkers::paint(MarkerArray& array, const std_msgs::ColorRGBA& color) const {
  for (const Part& part : parts_) array.markers[part.marker].color = color;
}

void SolidMarkers::show(MarkerArray& array, bool visible) const {
  for (const Part& part : parts_) {
    const Vec3 size = visible ? part.size : Vec3(Vec3::Constant(kNothing));
    setScale(array.markers[part.marker], size.x(), size.y(), size.z());
  }
}

Obstacle shapeOf(const ProbeOptions& probe) {
  Obstacle solid;
  solid.shape = probe.length > 0.0 ? Shape::Capsule : Shape::Sphere;
  solid.radius = probe.radius;
  solid.length = probe.length;
  solid.pose.orientation = probe.orientation;
  return solid;
}

}  // namespace haptic_cloth
