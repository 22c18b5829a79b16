/// The picture: cloth, mesh, probe, force and obstacles as rviz markers.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

/// Builds one MarkerArray a frame. Every marker keeps namespace, id and number of points from frame to
/// frame, so that rviz updates its buffers instead of rebuilding them.
class MarkerBuilder {
 public:
  /// @param force_scale length of the force arrow [m/N]
  MarkerBuilder(const Scene& scene, const std::string& frame_id, double force_scale);

  /// @param force on the probe, as sent to the device [N]
  const visualization_msgs::MarkerArray& build(const DisplayFrame& frame, const Vec3& force,
                                               const ros::Time& stamp);

 private:
  visualization_msgs::Marker& add(const std::string& name, int type);
  void addObstacle(const Obstacle& obstacle);
  void updateNormals(const DisplayFrame& frame);
  void updateSurface(const DisplayFrame& frame);
  void updateMesh(const DisplayFrame& frame);
  void updateProbe(const ProbeReport& probe, const Vec3& force);

  int columns_, rows_;
  int stride_;  ///< of the surface's vertices on the finest grid
  double probe_radius_;
  double force_scale_;
  std::string frame_id_;
  std::vector<Vec3> normals_;                ///< per finest particle
  std::vector<std_msgs::ColorRGBA> shade_;   ///< per finest particle
  visualization_msgs::MarkerArray markers_;  ///< surface, mesh, probe, proxy, force, obstacles
  enum Index { kSurface, kMesh, kProbe, kProxy, kForce };
};

}  // namespace haptic_cloth
