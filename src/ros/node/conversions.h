/// Between ROS messages or parameters and the library's types. Pure functions.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <haptic_cloth/ClothState.h>
#include <xmlrpcpp/XmlRpcValue.h>

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
Pose toPose(const geometry_msgs::Pose& pose);

/// Whether all numbers of the pose are finite.
bool isFinite(const geometry_msgs::Pose& pose);

/// Whether the quaternion's norm is 1 within 0.1.
bool isUnit(const geometry_msgs::Quaternion& orientation);

/// The pose of the child frame in the header's.
Pose toPose(const geometry_msgs::TransformStamped& transform);

/// A pose given in `frame`, in what `frame` is given in.
Pose composed(const Pose& frame, const Pose& pose);

geometry_msgs::WrenchStamped toWrench(const Wrench& wrench, const ros::Time& stamp,
                                      const std::string& frame_id);

/// The active mesh of a frame as a message. @param columns, rows of the finest grid
/// @param scratch maps finest particles to vertices; reused between calls
void toClothState(const DisplayFrame& frame, int columns, int rows, std::vector<int>& scratch,
                  ClothState& message);

/// The number a parameter holds, also where rosparam's YAML loader took it for a string (1e-3).
std::optional<double> toNumber(const XmlRpc::XmlRpcValue& value);

/// A parameter tree as YAML flow text. Strings that read as numbers stay plain (see toNumber).
/// @throws InputError for what YAML has no word for (binary, date); `key` names the place
std::string toYaml(const XmlRpc::XmlRpcValue& value, const std::string& origin, const std::string& key);

/// The leaves of a tree of maps as overrides "a.b=YAML"; a list is a leaf.
std::vector<std::string> toOverrides(const XmlRpc::XmlRpcValue& tree, const std::string& origin);

}  // namespace haptic_cloth
