#include "ros/input/force_types.h"

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <geometry_msgs/Wrench.h>
#include <geometry_msgs/WrenchStamped.h>

#include <vector>

namespace haptic_cloth {
namespace {

template <class Message>
ForceType standard() {
  return {ros::message_traits::datatype<Message>(), ros::message_traits::definition<Message>(), {}};
}

/// Message type of a driver, given by its fields; geometry_msgs/Vector3 is added.
ForceType own(const std::string& members, const std::map<std::string, int>& lengths = {}) {
  return {"",
          members + "===\nMSG: geometry_msgs/Vector3\n" +
              ros::message_traits::definition<geometry_msgs::Vector3>(),
          lengths};
}

const std::map<std::string, ForceType>& driverTypes() {
  static const std::map<std::string, ForceType> kTypes = {
      // phantom_omni and its successors; `position` is where the driver holds a locked tool.
      {"OmniFeedback", own("geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 position\n")},
      // ros_geomagic reads three locks whatever the length of the array.
      {"DeviceFeedback",
       own("geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 position\nbool[] lock\n", {{"lock", 3}})},
      // ros_falcon takes forces in whole newtons.
      {"falconForces", own("int16 X\nint16 Y\nint16 Z\n")}};
  return kTypes;
}

}  // namespace

std::optional<ForceType> findForceType(const std::string& datatype) {
  static const std::vector<ForceType> kStandard = {
      standard<geometry_msgs::WrenchStamped>(), standard<geometry_msgs::Wrench>(),
      standard<geometry_msgs::Vector3>(),       standard<geometry_msgs::Vector3Stamped>(),
      standard<geometry_msgs::Point>(),         standard<geometry_msgs::Twist>()};
  for (const ForceType& type : kStandard) {
    if (type.datatype == datatype) return type;
  }
  const auto entry = driverTypes().find(datatype.substr(datatype.find('/') + 1));
  if (entry == driverTypes().end()) return std::nullopt;
  ForceType type = entry->second;
  type.datatype = datatype;
  return type;
}

}  // namespace haptic_cloth
