/// The display thread: markers and mesh for those who listen, diagnostics for all.
#pragma once

#include <haptic_cloth/ClothState.h>
#include <ros/publisher.h>

#include "ros/device_input.h"
#include "ros/haptic_thread.h"
#include "ros/markers.h"
#include "ros/master_watch.h"
#include "ros/node_options.h"
#include "ros/shared_state.h"

namespace haptic_cloth {

/// What the display thread publishes to.
struct DisplayPublishers {
  ros::Publisher markers, state, proxy, diagnostics;
};

class DisplayThread {
 public:
  DisplayThread(const NodeOptions& options, const DisplayPublishers& publishers, const DeviceInput& input,
                const HapticThread& haptics, const MasterWatch& master, SharedState& shared);

  /// Runs until shared.stop.
  void run();

 private:
  void publishMarkers(const DisplayFrame& frame);
  void publishState(const DisplayFrame& frame);
  void publishProxy(const DisplayFrame& frame);
  void publishDiagnostics(double now);

  std::string frame_id_;
  int columns_, rows_;
  double markers_period_, state_period_;  ///< [s]
  double haptic_rate_;                    ///< [Hz]
  DisplayPublishers publishers_;
  const DeviceInput& input_;
  const HapticThread& haptics_;
  const MasterWatch& master_;
  SharedState& shared_;
  MarkerBuilder builder_;
  ClothState state_;
  std::vector<int> scratch_;
  std::uint64_t marker_frames_ = 0, state_frames_ = 0;
};

}  // namespace haptic_cloth
