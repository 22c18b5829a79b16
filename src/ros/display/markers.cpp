#include "ros/display/markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>

#include "ros/node/conversions.h"
#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

using visualization_msgs::Marker;

/// Largest number of triangles. rviz shows 20,000 at 30 Hz even without a graphics card; a finer
/// grid is thinned out.
constexpr int kMaxTriangles = 20000;
constexpr double kAmbient = 0.35;  ///< share of ambient light [-]
/// Height of the mesh lines above the surface, against flicker [m].
constexpr double kLineLift = 3e-4;
constexpr double kFoldedOver = -0.5;  ///< z of the normal of cloth that shows its back to one above [-]
constexpr double kTextHeight = 0.035, kTextLift = 0.5;  ///< of the text on quality, in sides of the cloth [-]
constexpr std::size_t kTextWidth = 40;                  ///< of its longest line [characters]
constexpr float kClothRed = 0.25F, kClothGreen = 0.50F, kClothBlue = 0.85F;

std_msgs::ColorRGBA levelColor(int level) {
  static const std::array<std_msgs::ColorRGBA, 4> kColors{
      markerColor(0.90F, 0.20F, 0.10F), markerColor(1.0F, 0.75F, 0.1F), markerColor(0.95F, 0.95F, 0.95F),
      markerColor(0.4F, 1.0F, 0.6F)};
  return kColors[std::clamp(level, 0, 3)];
}

/// Colour of a load: white for zero, red for `full` or more.
std_msgs::ColorRGBA loadColor(double load, double full) {
  const auto share = static_cast<float>(std::clamp(load / full, 0.0, 1.0));
  return markerColor(0.95F - 0.05F * share, 0.95F - 0.85F * share, 0.95F - 0.90F * share);
}

/// Colour of a proxy: orange if open, yellow-green if closed, green if it holds cloth.
std_msgs::ColorRGBA graspColor(GraspState grasp) {
  switch (grasp) {
    case GraspState::Closed:
      return markerColor(0.75F, 0.75F, 0.15F);
    case GraspState::Holding:
      return markerColor(0.15F, 0.75F, 0.25F);
    case GraspState::Open:
      break;
  }
  return markerColor(0.95F, 0.55F, 0.1F);
}

/// Smallest power of two that divides the grid and keeps the surface within kMaxTriangles. If there
/// is none, the largest that divides the grid.
int surfaceStride(int columns, int rows) {
  int stride = 1;
  while (2 * ((columns - 1) / stride) * ((rows - 1) / stride) > kMaxTriangles &&
         (columns - 1) % (2 * stride) == 0 && (rows - 1) % (2 * stride) == 0) {
    stride *= 2;
  }
  return stride;
}

/// Breaks a line between words where it would be longer than kTextWidth.
std::string wrapped(std::string text) {
  std::size_t start = 0, space = std::string::npos;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == ' ') space = k;
    if (k - start < kTextWidth || space == std::string::npos || space < start) continue;
    text[space] = '\n';
    start = space + 1;
  }
  return text;
}

}  // namespace

MarkerBuilder::MarkerBuilder(const Scene& scene, const std::string& frame_id, const MarkerOptions& options)
    : columns_(scene.cloth.particles[0]),
      rows_(scene.cloth.particles[1]),
      stride_(surfaceStride(columns_, rows_)),
      side_(std::max(scene.cloth.size[0], scene.cloth.size[1])),
      options_(options),
      frame_id_(frame_id) {
  addMarker(markers_, "surface", Marker::TRIANGLE_LIST, frame_id);
  addMarker(markers_, "mesh", Marker::LINE_LIST, frame_id).scale.x = 0.0005;
  for (const ProbeOptions& probe : scene.probes) addProbe(probe);
  for (const Obstacle& obstacle : scene.obstacles) {
    obstacles_.emplace_back(markers_, "obstacles", obstacle, markerColor(0.55F, 0.55F, 0.58F), frame_id);
  }
  Marker& quality = addMarker(markers_, "quality", Marker::TEXT_VIEW_FACING, frame_id);
  quality.color = markerColor(0.95F, 0.75F, 0.1F);
  quality.scale.z = kTextHeight * side_;  // rviz uses no other
}

void MarkerBuilder::addProbe(const ProbeOptions& probe) {
  const Obstacle solid = solidOf(probe);
  const SolidMarkers device(markers_, probe.name + "/device", solid, markerColor(0.9F, 0.9F, 0.2F, 0.4F),
                            frame_id_);
  const SolidMarkers proxy(markers_, probe.name + "/proxy", solid, graspColor(GraspState::Open), frame_id_);
  probes_.push_back({probe.name, device, proxy, markers_.markers.size()});
  Marker& arrow = addMarker(markers_, probe.name + "/force", Marker::ARROW, frame_id_);
  arrow.color = markerColor(0.85F, 0.1F, 0.5F);
  setScale(arrow, 0.004, 0.008, 0.0);
}

const visualization_msgs::MarkerArray& MarkerBuilder::build(const DisplayFrame& frame,
                                                            const std::vector<Vec3>& forces,
                                                            const ros::Time& stamp) {
  updateNormals(frame);
  updateSurface(frame);
  updateMesh(frame);
  updateQuality(frame, forces);
  for (std::size_t k = 0; k < probes_.size(); ++k) updateProbe(probes_[k], frame.probes[k], forces[k]);
  for (std::size_t k = 0; k < obstacles_.size(); ++k) obstacles_[k].place(markers_, frame.obstacles[k]);
  for (Marker& marker : markers_.markers) marker.header.stamp = stamp;
  return markers_;
}

/// Computes smooth normals by central differences on the grid, and the shading from them. rviz
/// itself would shade every triangle flat, and would not shade triangles whose vertices have
/// colours.
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
      shade_[j * columns_ + i] = markerColor(kClothRed * lit, kClothGreen * lit, kClothBlue * lit);
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

std_msgs::ColorRGBA MarkerBuilder::lineColor(const DisplayFrame& frame, std::size_t cell) const {
  switch (options_.colouring) {
    case MeshColouring::Tension:
      return loadColor(frame.tension[cell], options_.full_tension);
    case MeshColouring::Bending:
      return loadColor(frame.bending[cell], options_.full_bending);
    case MeshColouring::Level:
      break;
  }
  return levelColor(frame.cells[cell].level);
}

/// Draws the left and lower side of every leaf and the far borders of the cloth: every line once, on the
/// upper side of the cloth, or on its back where it is folded over and the back faces up.
void MarkerBuilder::updateMesh(const DisplayFrame& frame) {
  Marker& mesh = markers_.markers[kMesh];
  mesh.points.clear();
  mesh.colors.clear();
  const auto line = [&](int from, int to, const std_msgs::ColorRGBA& color) {
    for (const int particle : {from, to}) {
      const Vec3& normal = normals_[particle];
      const double lift = normal.z() < kFoldedOver ? -kLineLift : kLineLift;
      mesh.points.push_back(toPoint(frame.positions[particle] + lift * normal));
      mesh.colors.push_back(color);
    }
  };
  for (std::size_t k = 0; k < frame.cells.size(); ++k) {
    const auto& corner = frame.cells[k].particles;
    const std_msgs::ColorRGBA color = lineColor(frame, k);
    line(corner[0], corner[1], color);
    line(corner[0], corner[2], color);
    if (corner[1] % columns_ == columns_ - 1) line(corner[1], corner[3], color);
    if (corner[2] / columns_ == rows_ - 1) line(corner[2], corner[3], color);
  }
  const std::size_t lines = static_cast<std::size_t>(2 * (columns_ - 1) * (rows_ - 1) + columns_ + rows_ - 2);
  const geometry_msgs::Point last = mesh.points.empty() ? geometry_msgs::Point() : mesh.points.back();
  mesh.points.resize(2 * lines, last);
  mesh.colors.resize(2 * lines, levelColor(0));
}

/// Shows what is given up and the error of the forces, above the cloth. Nothing is shown at the quality that
/// the scene asks for. On one rung the number of lines stays, so that the text does not jump.
void MarkerBuilder::updateQuality(const DisplayFrame& frame, const std::vector<Vec3>& forces) {
  Marker& text = markers_.markers.back();
  text.action = frame.quality.rung == 0 ? Marker::DELETE : Marker::ADD;
  text.text = "reduced quality (rung " + std::to_string(frame.quality.rung) + "):\n" +
              wrapped(frame.quality.given_up);
  for (std::size_t k = 0; k < frame.probes.size(); ++k) {
    char line[64];
    std::snprintf(line, sizeof(line), ": force %.2f N, error %.2f N", forces[k].norm(),
                  frame.probes[k].force_error);
    text.text += '\n' + probes_[k].name + line;
  }
  const Vec3 middle = std::accumulate(frame.positions.begin(), frame.positions.end(), Vec3(Vec3::Zero())) /
                      static_cast<double>(frame.positions.size());
  text.pose.position = toPoint(middle + kTextLift * side_ * Vec3::UnitZ());
}

void MarkerBuilder::updateProbe(const ProbeMarkers& markers, const ProbeView& probe, const Vec3& force) {
  const ProbeReport& report = probe.report;
  markers.device.place(markers_, {report.device, probe.orientation});
  markers.proxy.place(markers_, {report.proxy, report.orientation});
  for (const SolidMarkers& solid : {markers.device, markers.proxy}) solid.show(markers_, report.present);
  markers.proxy.paint(markers_, graspColor(probe.grasp));
  Marker& arrow = markers_.markers[markers.arrow];
  const Vec3 tip = report.proxy + options_.force_scale * force;
  arrow.points = {toPoint(report.proxy), toPoint(tip)};
  // rviz warns about an arrow without length.
  arrow.action = (tip - report.proxy).norm() > 1e-4 ? Marker::ADD : Marker::DELETE;
}

}  // namespace haptic_cloth
