/// Adapter between the node and a driver with other messages than PoseStamped and WrenchStamped.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>
#include <topic_tools/shape_shifter.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ros/input/driver_messages.h"
#include "ros/input/pose_gate.h"
#include "scene/option.h"

namespace haptic_cloth {

/// Private parameters of the adapter, with their defaults.
struct AdapterOptions {
  std::string pose_frame;  ///< frame_id of the pose; empty: that of the driver's header
  std::string force_type;  ///< package/Name; empty: the type with which the driver subscribes
  double timeout = 0.05;   ///< zero is sent after this silence of the node [s]
  /// Time in which the force rises after zeros that the node did not send [s]; 0: it jumps.
  double soft_start = 0.5;
};

std::vector<OptionGroup> groupsOf(AdapterOptions& adapter);

/// Type of `topic` according to the master, if the master knows one.
std::optional<std::string> typeOnMaster(const std::string& topic);

/// device/pose (a type of driver_messages.h) → probe/pose.
class PoseAdapter {
 public:
  PoseAdapter(ros::NodeHandle& node, const AdapterOptions& options);

  /// Subscribes again if no positions come and a driver with another type has: roscpp keeps to the first
  /// type. Call it every few milliseconds, from one thread.
  void look();

 private:
  void subscribe();
  void accept(const ros::MessageEvent<topic_tools::ShapeShifter const>& event);

  AdapterOptions options_;
  ros::NodeHandle node_;
  ros::Publisher pose_;
  std::string md5sum_;               ///< of the newest message; empty before the first
  PositionReader reader_ = nullptr;  ///< for messages with that sum
  std::mutex mutex_;                 ///< protects the next two
  double heard_ = -1.0;              ///< newest position, steady clock [s]
  std::string type_;            ///< of the newest message, or of the driver for which it subscribed again
  double asked_ = -1.0;         ///< last question to the master for the type, steady clock [s]
  PoseGate gate_;               ///< keeps to the first sender, as the node's does
  ros::Subscriber subscriber_;  ///< last member: its callbacks use all members above
};

/// probe/reaction → device/force (a type of driver_messages.h). Sends zero if the node is silent, if a force
/// is not finite, and at the end, because drivers hold the last force for ever. After such zeros the force
/// rises softly.
class ForceAdapter {
 public:
  /// @throws InputError for a type that is not known
  ForceAdapter(ros::NodeHandle& node, const AdapterOptions& options);

  /// Asks for the driver's type until it is known, and sends zero if no force comes. Call it every
  /// few milliseconds.
  void look();

  /// Sends zeros and waits until the last one has left the process.
  void end();

 private:
  void accept(const geometry_msgs::WrenchStamped& wrench);
  /// Asks the master for the driver's type and advertises it if it is known.
  void learn();
  /// @throws InputError for a type that is not known
  void advertise(const std::string& datatype);
  void send(const Vec3& force, const MessageHeader& header);
  void sendZero(const MessageHeader& header);

  AdapterOptions options_;
  ros::NodeHandle node_;
  std::mutex mutex_;  ///< protects all members below
  const ForceType* type_ = nullptr;
  topic_tools::ShapeShifter message_;
  ros::Publisher force_;
  double received_ = -1.0;    ///< last finite force, steady clock [s]; < 0: none yet
  double rises_from_ = -1.0;  ///< first one after a zero of the adapter's own, steady clock [s]
  bool zero_ = true;          ///< such a zero was sent last
  double asked_ = -1.0;       ///< last question to the master for the type, steady clock [s]
  std::string refused_;       ///< type that was found but not understood; reported once
  bool ended_ = false;
  ros::Subscriber subscriber_;  ///< last member: its callbacks use all members above
};

}  // namespace haptic_cloth
