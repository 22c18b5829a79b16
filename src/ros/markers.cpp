#include "ros/markers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ros/conversions.h"

namespace haptic_cloth {
namespace {

using visualization_msgs::Marker;

/// rviz shows 20,000 triangles at 30 Hz even without a graphics card; a finer grid is thinned out.
constexpr int kMaxTriangles = 20000;
constexpr double kAmbient = 0.35;      ///< share of light from everywhere [-]
constexpr double kLineLift = 3e-4;     ///< mesh lines above the surface, against flicker [m]
constexpr double kPlaneSide = 2.0;     ///< of the drawn part of a plane [m]
constexpr double kPlaneDepth = 0.002;  ///< [m]
constexpr float kClothRed = 0.25F, kClothGreen = 0.50F, kClothBlue = 0.85F;

std_msgs::ColorRGBA color(float r, float g, float b, float a = 1.0F) {
  std_msgs::ColorRGBA color;
  color.r = r;
  color.g = g;
  color.b = b;
  color.a = a;
  return color;
}

std_msgs::ColorRGBA levelColor(int level) {
  static const std::array<std_msgs::ColorRGBA, 4> kColors{
      color(0.90F, 0.20F, 0.10F), color(1.0F, 0.75F, 0.1F), color(0.95F, 0.95F, 0.95F),
      color(0.4F, 1.0F, 0.6F)};
  return kColors[std::clamp(level, 0, 3)];
}

void setScale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

/// Smallest step that divides the grid and keeps the surface below kMaxTriangles.
int surfaceStride(int columns, int rows) {
  int stride = 1;
  while (2 * ((columns - 1) / stride) * ((rows - 1) / stride) > kMaxTriangles &&
         (columns - 1) % (2 * stride) == 0 && (rows - 1) % (2 * stride) == 0) {
    stride *= 2;
  }
  return stride;
}

}  // namespace

MarkerBuilder::MarkerBuilder(const Scene& scene, const std::string& frame_id, double force_scale)
    : columns_(scene.cloth.particles[0]),
      rows_(scene.cloth.particles[1]),
      stride_(surfaceStride(columns_, rows_)),
      probe_radius_(scene.probes[0].radius),
      force_scale_(force_scale),
      frame_id_(frame_id) {
  add("surface", Marker::TRIANGLE_LIST);
  add("mesh", Marker::LINE_LIST).scale.x = 0.0005;
  add("probe", Marker::SPHERE).color = color(0.9F, 0.9F, 0.2F, 0.4F);
  add("proxy", Marker::SPHERE).color = color(0.95F, 0.55F, 0.1F);
  add("force", Marker::ARROW).color = color(0.85F, 0.1F, 0.5F);
  setScale(markers_.markers[kForce], 0.004, 0.008, 0.0);
  for (const Obstacle& obstacle : scene.obstacles) addObstacle(obstacle);
}

Marker& MarkerBuilder::add(const std::string& name, int type) {
  Marker marker;
  marker.header.frame_id = frame_id_;
  marker.ns = name;
  marker.id = static_cast<int>(markers_.markers.size());
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  setScale(marker, 1.0, 1.0, 1.0);
  marker.color = color(1.0F, 1.0F, 1.0F);
  markers_.markers.push_back(marker);
  return markers_.markers.back();
}

void MarkerBuilder::addObstacle(const Obstacle& obstacle) {
  const auto part = [&](int type, const Vec3& offset) -> Marker& {
    Marker& marker = add("obstacles", type);
    marker.pose =
        toPose(obstacle.pose.position + obstacle.pose.orientation * offset, obstacle.pose.orientation);
    marker.color = color(0.55F, 0.55F, 0.58F);
    return marker;
  };
  const double diameter = 2.0 * obstacle.radius;
  switch (obstacle.shape) {
    case Shape::Box:
      setScale(part(Marker::CUBE, Vec3::Zero()), obstacle.size.x(), obstacle.size.y(), obstacle.size.z());
      break;
    case Shape::Sphere:
      setScale(part(Marker::SPHERE, Vec3::Zero()), diameter, diameter, diameter);
      break;
    case Shape::Cylinder:
      setScale(part(Marker::CYLINDER, Vec3::Zero()), diameter, diameter, obstacle.length);
      break;
    case Shape::Capsule:
      setScale(part(Marker::CYLINDER, Vec3::Zero()), diameter, diameter, obstacle.length);
      for (const double side : {-0.5, 0.5}) {
        setScale(part(Marker::SPHERE, side * obstacle.length * Vec3::UnitZ()), diameter, diameter, diameter);
      }
      break;
    case Shape::Plane:
      setScale(part(Marker::CUBE, -0.5 * kPlaneDepth * Vec3::UnitZ()), kPlaneSide, kPlaneSide, kPlaneDepth);
      break;
  }
}

const visualization_msgs::MarkerArray& MarkerBuilder::build(const DisplayFrame& frame, const Vec3& force,
                                                            const ros::Time& stamp) {
  updateNormals(frame);
  updateSurface(frame);
  updateMesh(frame);
  updateProbe(frame.probe, force);
  for (Marker& marker : markers_.markers) marker.header.stamp = stamp;
  return markers_;
}

/// Smooth normals by central differences on the grid, and from them the light: rviz itself would shade
/// every triangle flat, and not at all where vertices have colours.
void MarkerBuilder::updateNormals(const DisplayFrame& frame) {
  const Vec3 light = Vec3(0.35, -0.5, 0.8).normalized();
  normals_.resize(frame.positions.size());
  shade_.resize(frame.positions.size());
  const auto at = [&](int i, int j) -> const Vec3& { return frame.positions[j * columns_ + i]; };
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const Vec3 along = at(std::min(i + stride_, columns_ - 1), j) - at(std::max(i - stride_, 0), j);
      const Vec3 across = at(i, std::min(j + stride_, rows_ - 1)) - at(i, std::max(j - stride_, 0));
      Vec3 normal = along.cross(across);
      const double norm = normal.norm();
      normal = norm > 0.0 ? Vec3(normal / norm) : Vec3(Vec3::UnitZ());
      const auto lit = static_cast<float>(kAmbient + (1.0 - kAmbient) * std::abs(normal.dot(light)));
      normals_[j * columns_ + i] = normal;
      shade_[j * columns_ + i] = color(kClothRed * lit, kClothGreen * lit, kClothBlue * lit);
    }
  }
}

void MarkerBuilder::updateSurface(const DisplayFrame& frame) {
  Marker& surface = markers_.markers[kSurface];
  surface.points.clear();
  surface.colors.clear();
  const auto corner = [&](int i, int j) {
    const int particle = j * columns_ + i;
    surface.points.push_back(toPoint(frame.positions[particle]));
    surface.colors.push_back(shade_[particle]);
  };
  for (int j = 0; j + stride_ < rows_; j += stride_) {
    for (int i = 0; i + stride_ < columns_; i += stride_) {
      corner(i, j);
      corner(i + stride_, j);
      corner(i + stride_, j + stride_);
      corner(i, j);
      corner(i + stride_, j + stride_);
      corner(i, j + stride_);
    }
  }
}

/// Left and lower side of every leaf, and the cloth's far border: together every line once.
void MarkerBuilder::updateMesh(const DisplayFrame& frame) {
  Marker& mesh = markers_.markers[kMesh];
  mesh.points.clear();
  mesh.colors.clear();
  const auto line = [&](int from, int to, int level) {
    for (const int particle : {from, to}) {
      mesh.points.push_back(toPoint(frame.positions[particle] + kLineLift * normals_[particle]));
      mesh.colors.push_back(levelColor(level));
    }
  };
  for (const CellView& cell : frame.cells) {
    const auto& corner = cell.particles;
    line(corner[0], corner[1], cell.level);
    line(corner[0], corner[2], cell.level);
    if (corner[1] % columns_ == columns_ - 1) line(corner[1], corner[3], cell.level);
    if (corner[2] / columns_ == rows_ - 1) line(corner[2], corner[3], cell.level);
  }
  const std::size_t lines = static_cast<std::size_t>(2 * (columns_ - 1) * (rows_ - 1) + columns_ + rows_ - 2);
  const geometry_msgs::Point last = mesh.points.empty() ? geometry_msgs::Point() : mesh.points.back();
  mesh.points.resize(2 * lines, last);
  mesh.colors.resize(2 * lines, levelColor(0));
}

void MarkerBuilder::updateProbe(const ProbeReport& probe, const Vec3& force) {
  // An absent probe is not deleted but shrunk to nothing visible, so that it needs no second message.
  const double diameter = probe.present ? 2.0 * probe_radius_ : 1e-6;
  for (const Index index : {kProbe, kProxy}) {
    Marker& marker = markers_.markers[index];
    marker.pose.position = toPoint(index == kProbe ? probe.device : probe.proxy);
    setScale(marker, diameter, diameter, diameter);
  }
  Marker& arrow = markers_.markers[kForce];
  const Vec3 tip = probe.proxy + force_scale_ * force;
  arrow.points = {toPoint(probe.proxy), toPoint(tip)};
  // rviz warns of an arrow without length.
  arrow.action = (tip - probe.proxy).norm() > 1e-4 ? Marker::ADD : Marker::DELETE;
}

}  // namespace haptic_cloth
