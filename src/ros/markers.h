/// The picture: cloth, mesh, probes, forces and obstacles as rviz markers.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "ros/shared_state.h"
#include "ros/solid_markers.h"

namespace haptic_cloth {

/// Builds one MarkerArray a frame. Every marker keeps namespace, id and number of points from frame to
/// frame, so that rviz updates its buffers instead of rebuilding them.
class MarkerBuilder {
 public:
  /// @param force_scale length of the force arrow [m/N]
  MarkerBuilder(const Scene& scene, const std::string& frame_id, double force_scale);

  /// @param forces on each probe, as sent to its device [N]
  const visualization_msgs::MarkerArray& build(const DisplayFrame& frame, const std::vector<Vec3>& forces,
                                               const ros::Time& stamp);

 private:
  /// A probe where its device is, where the cloth lets it be, and the force between.
  struct ProbeMarkers {
    SolidMarkers device, proxy;
    std::size_t arrow;  ///< index among the markers
  };

  void addProbe(const ProbeOptions& probe);
  void updateNormals(const DisplayFrame& frame);
  void updateSurface(const DisplayFrame& frame);
  void updateMesh(const DisplayFrame& frame);
  void updateProbe(const ProbeMarkers& markers, const ProbeView& probe, const Vec3& force);

  int columns_, rows_;
  int stride_;  ///< of the surface's vertices on the finest grid
  double force_scale_;
  std::string frame_id_;
  std::vector<Vec3> normals_;                ///< per finest particle
  std::vector<std_msgs::ColorRGBA> shade_;   ///< per finest particle
  visualization_msgs::MarkerArray markers_;  ///< surface, mesh, then probes and obstacles
  std::vector<ProbeMarkers> probes_;
  std::vector<SolidMarkers> obstacles_;
  enum Index { kSurface, kMesh };
};

}  // namespace haptic_cloth
