/// The display thread: markers, mesh and proxies for subscribers, diagnostics for all.
#pragma once

#include <haptic_cloth/ClothState.h>
#include <ros/publisher.h>

#include <deque>
#include <vector>

#include "ros/display/markers.h"
#include "ros/haptic/haptic_thread.h"
#include "ros/haptic/probe_topics.h"
#include "ros/input/obstacle_topics.h"
#include "ros/node/master_watch.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Publishers of the display thread.
struct DisplayPublishers {
  ros::Publisher markers, state, diagnostics;
};

/// The parts of the node that the display thread reports on.
struct DisplaySources {
  std::string name;  ///< name of the node, put before the name of each status
  const std::deque<ProbeTopics>& probes;
  const std::deque<ObstacleTopics>& obstacles;
  const HapticThread& haptics;
  const MasterWatch& master;
};

class DisplayThread {
 public:
  DisplayThread(const NodeOptions& options, const DisplayPublishers& publishers,
                const DisplaySources& sources, SharedState& shared);

  /// Runs until `shared.stop`.
  void run();

 private:
  void takeOptions();
  void publishMarkers(const DisplayFrame& frame);
  void publishState(const DisplayFrame& frame);
  bool proxiesWanted() const;
  void publishProxies(const DisplayFrame& frame);
  void publishDiagnostics(double now);

  std::string frame_id_;
  int columns_, rows_;
  double markers_period_, state_period_;        ///< [s]
  double markers_due_ = 0.0, state_due_ = 0.0;  ///< steady clock [s]
  /// First rounds with the present subscribers, steady clock [s]; < 0: there are none.
  double markers_since_ = -1.0, state_since_ = -1.0;
  DisplayPublishers publishers_;
  DisplaySources sources_;
  SharedState& shared_;
  LiveReader live_;
  MarkerBuilder builder_;
  ClothState state_;
  std::vector<int> scratch_;
  std::vector<Vec3> forces_;
  std::uint64_t marker_frames_ = 0, state_frames_ = 0;
};

}  // namespace haptic_cloth
