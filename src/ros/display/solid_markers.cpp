#include "ros/display/solid_markers.h"

#include "ros/node/conversions.h"
#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kNothing = 1e-6;  ///< size of a hidden marker [m]

int markerType(DrawnPart::Body body) {
  switch (body) {
    case DrawnPart::kSphere:
      return Marker::SPHERE;
    case DrawnPart::kCylinder:
      return Marker::CYLINDER;
    case DrawnPart::kCube:
      break;
  }
  return Marker::CUBE;
}

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
  for (const DrawnPart& part : drawing(solid)) {
    parts_.push_back({array.markers.size(), part.offset, part.size});
    addMarker(array, name, markerType(part.body), frame_id).color = color;
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

}  // namespace haptic_cloth
