/// The picture in rviz: cloth, mesh, probes, forces and obstacles as markers.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "ros/display/solid_markers.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// Builds one MarkerArray per frame. Every marker keeps its namespace, id and number of points, so
/// rviz updates its buffers instead of rebuilding them.
class MarkerBuilder {
 public:
  MarkerBuilder(const Scene& scene, const std::string& frame_id, const MarkerOptions& options);

  /// Takes effect with the next frame.
  void setOptions(const MarkerOptions& options) { options_ = options; }

  /// @param forces force on the hand of each probe, in the cloth's axes [N]
  const visualization_msgs::MarkerArray& build(const DisplayFrame& frame, const std::vector<Vec3>& forces,
                                               const ros::Time& stamp);

 private:
  /// Markers of one probe: its device, its proxy and its force.
  struct ProbeMarkers {
    std::string name;
    SolidMarkers device, proxy;
    std::size_t arrow;  ///< index in the array
  };

  void addProbe(const ProbeOptions& probe);
  void updateNormals(const DisplayFrame& frame);
  void updateSurface(const DisplayFrame& frame);
  std_msgs::ColorRGBA lineColor(const DisplayFrame& frame, std::size_t cell) const;
  void updateMesh(const DisplayFrame& frame);
  void updateQuality(const DisplayFrame& frame, const std::vector<Vec3>& forces);
  void updateProbe(const ProbeMarkers& markers, const ProbeView& probe, const Vec3& force);

  int columns_, rows_;
  int stride_;   ///< distance of the surface's vertices on the finest grid
  double side_;  ///< longer side of the cloth [m]
  MarkerOptions options_;
  std::string frame_id_;
  std::vector<Vec3> normals_;                ///< per finest particle
  std::vector<std_msgs::ColorRGBA> shade_;   ///< per finest particle
  visualization_msgs::MarkerArray markers_;  ///< surface, mesh, probes, obstacles, quality
  std::vector<ProbeMarkers> probes_;
  std::vector<SolidMarkers> obstacles_;
  enum Index { kSurface, kMesh };
};

}  // namespace haptic_cloth
