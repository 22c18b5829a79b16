/// One solid in the picture: one marker for each part of its drawing.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

std_msgs::ColorRGBA markerColor(float r, float g, float b, float a = 1.0F);
void setScale(visualization_msgs::Marker& marker, double x, double y, double z);

/// Appends a marker with unit scale. Its id is its index in the array.
visualization_msgs::Marker& addMarker(visualization_msgs::MarkerArray& array, const std::string& name,
                                      int type, const std::string& frame_id);

/// A solid among the markers of an array. It keeps the same markers in every frame.
class SolidMarkers {
 public:
  SolidMarkers(visualization_msgs::MarkerArray& array, const std::string& name, const Obstacle& solid,
               const std_msgs::ColorRGBA& color, const std::string& frame_id);

  void place(visualization_msgs::MarkerArray& array, const Pose& pose) const;
  void paint(visualization_msgs::MarkerArray& array, const std_msgs::ColorRGBA& color) const;
  /// Shows or hides the solid. A hidden solid is shrunk instead of deleted, so no second message is
  /// needed.
  void show(visualization_msgs::MarkerArray& array, bool visible) const;

 private:
  struct Part {
    std::size_t marker;  ///< index in the array
    Vec3 offset;         ///< in the solid's frame [m]
    Vec3 size;           ///< [m]
  };
  std::vector<Part> parts_;
};

}  // namespace haptic_cloth
