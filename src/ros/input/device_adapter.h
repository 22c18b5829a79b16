/// Between the node and a driver whose messages are neither PoseStamped nor WrenchStamped.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>
#include <topic_tools/shape_shifter.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ros/input/force_types.h"
#include "ros/input/vector_field.h"
#include "ros/options/parameter_group.h"

namespace haptic_cloth {

/// The private parameters of the adapter. Each default stands here only.
struct AdapterOptions {
  std::string
      pose_field;  ///< where the position stands, as "pose.position"; empty: the first place that fits
  std::string pose_frame;        ///< frame_id of the pose; empty: that of the driver's header
  std::string force_type;        ///< package/Name; empty: as the driver subscribed to it
  std::string force_definition;  ///< of a type that is not known here, with the types in it
  std::string force_field;       ///< where the force stands; empty: the first place that fits
  double timeout = 0.05;         ///< after which the force is zero unless the node renews it [s]
};

/// @throws InputError for unknown keys and impossible values
AdapterOptions readAdapterOptions(ParameterGroup group);

/// The type that somebody on `topic` has told the master of, if any.
std::optional<std::string> typeOnMaster(const std::string& topic);

/// device/pose (any type) → probe/pose.
class PoseAdapter {
 public:
  PoseAdapter(ros::NodeHandle& node, const AdapterOptions& options);

 private:
  void accept(const topic_tools::ShapeShifter::ConstPtr& message);
  /// Learns where the position stands. @return whether it is known
  bool learn(const topic_tools::ShapeShifter& message);

  AdapterOptions options_;
  ros::Publisher pose_;
  ros::Subscriber subscriber_;
  std::string fingerprint_;  ///< of the type the reader is for; empty before the first message
  std::optional<VectorReader> reader_;
  std::vector<unsigned char> bytes_;
};

/// probe/reaction → device/force (any type). Sends zero when the node is silent, when a force is not finite,
/// and at the end: drivers hold the last force for ever.
class ForceAdapter {
 public:
  /// @throws InputError for a type that cannot take a force
  ForceAdapter(ros::NodeHandle& node, const AdapterOptions& options);

  /// To be called every few milliseconds: learns the driver's type, and watches that forces come.
  void look();

  /// Sends zeros, and gives the last one time to go.
  void end();

 private:
  void accept(const geometry_msgs::WrenchStamped& wrench);
  /// Advertises a type once it is known.
  void learn();
  void advertise(const ForceType& type);
  void send(const Vec3& force, const MessageHeader& header);

  AdapterOptions options_;
  ros::NodeHandle node_;
  std::mutex mutex_;  ///< of all below
  std::optional<VectorWriter> writer_;
  topic_tools::ShapeShifter message_;
  ros::Publisher force_;
  double received_ = -1.0;  ///< last finite force, steady clock [s]; < 0: none yet
  double asked_ = -1.0;     ///< the master for the type, steady clock [s]
  std::string refused_;     ///< a type that was found and not understood; said once
  bool ended_ = false;
  ros::Subscriber subscriber_;  ///< last: its callbacks use all above
};

}  // namespace haptic_cloth
