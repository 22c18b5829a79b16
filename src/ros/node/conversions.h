/// Conversions between ROS messages or parameters and the types of the library. Pure functions.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <haptic_cloth/ClothState.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/types.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

Vec3 toVec3(const geometry_msgs::Point& point);
geometry_msgs::Point toPoint(const Vec3& position);
Quat toQuat(const geometry_msgs::Quaternion& orientation);
geometry_msgs::Pose toPose(const Vec3& position, const Quat& orientation = Quat::Identity());
geometry_msgs::Pose toPose(const Pose& pose);
Pose toPose(const geometry_msgs::Pose& pose);

/// Time from one stamp to another [s]. The difference of two ros::Time throws beyond 68 years, and stamps
/// come from other programs.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  return static_cast<double>(to.sec) - static_cast<double>(from.sec) +
         1e-9 * (static_cast<double>(to.nsec) - static_cast<double>(from.nsec));
}

/// Whether all numbers of the pose are finite.
bool isFinite(const geometry_msgs::Pose& pose);

/// Whether the norm of the quaternion is within 0.1 of 1.
bool isUnit(const geometry_msgs::Quaternion& orientation);

/// Pose of the child frame in the header's frame.
Pose toPose(const geometry_msgs::TransformStamped& transform);

/// Transforms a pose from `frame` into the parent of `frame`.
Pose composed(const Pose& frame, const Pose& pose);

/// Name of a frame as tf2 knows it: without the slash with which tf names began, and any further ones.
inline std::string withoutSlash(const std::string& frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}

geometry_msgs::WrenchStamped toWrench(const Wrench& wrench, const ros::Time& stamp,
                                      const std::string& frame_id);

/// Writes the active mesh of a frame into a message.
/// @param columns, rows size of the finest grid
/// @param scratch maps finest particles to vertices; reused between calls
void toClothState(const DisplayFrame& frame, int columns, int rows, std::vector<int>& scratch,
                  ClothState& message);

/// Number in a parameter, even if rosparam's YAML loader read it as text (1e-3).
std::optional<double> toNumber(const XmlRpc::XmlRpcValue& value);

/// Parameter tree as YAML in flow style. Text that reads as a number is not quoted (see toNumber).
/// @throws InputError for types that YAML lacks (binary, date); `key` names the place in the
/// message
std::string toYaml(const XmlRpc::XmlRpcValue& value, const std::string& origin, const std::string& key);

/// Leaves of a tree of maps as overrides "a.b=YAML". A list is a leaf.
std::vector<std::string> toOverrides(const XmlRpc::XmlRpcValue& tree, const std::string& origin);

}  // namespace haptic_cloth
