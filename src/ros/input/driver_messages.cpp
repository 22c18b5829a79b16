#include "ros/input/driver_messages.h"

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <sensor_msgs/Joy.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int8MultiArray.h>

#include <algorithm>
#include <boost/array.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

namespace haptic_cloth {
namespace {

namespace traits = ros::message_traits;
using Bytes = std::vector<unsigned char>;

// TouchState of a geomagic driver, in two versions: a PoseStamped with buttons, and a
// TransformStamped with velocity and buttons.
constexpr char kTouchState[] = "882b066d515316daecadf177b58cf445";
constexpr char kMovingTouchState[] = "30e5c9275c60943d770c087f33b76fac";

Vec3 positionIn(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }
Vec3 positionIn(const geometry_msgs::Vector3& vector) { return {vector.x, vector.y, vector.z}; }
Vec3 positionIn(const geometry_msgs::Pose& pose) { return positionIn(pose.position); }
Vec3 positionIn(const geometry_msgs::Twist& twist) { return positionIn(twist.linear); }
Vec3 positionIn(const geometry_msgs::Transform& transform) { return positionIn(transform.translation); }
Vec3 positionIn(const geometry_msgs::PointStamped& message) { return positionIn(message.point); }
Vec3 positionIn(const geometry_msgs::Vector3Stamped& message) { return positionIn(message.vector); }
Vec3 positionIn(const geometry_msgs::PoseStamped& message) { return positionIn(message.pose); }
Vec3 positionIn(const geometry_msgs::TwistStamped& message) { return positionIn(message.twist); }
Vec3 positionIn(const geometry_msgs::TransformStamped& message) { return positionIn(message.transform); }

/// Parts that follow each other at the start of a message.
/// @return empty if the message is too short
template <class... Parts>
std::optional<std::tuple<Parts...>> startOf(const topic_tools::ShapeShifter& message) {
  Bytes bytes(message.size());
  ros::serialization::OStream copy(bytes.data(), message.size());
  message.write(copy);
  ros::serialization::IStream stream(bytes.data(), message.size());
  std::tuple<Parts...> parts;
  try {
    std::apply([&](auto&... part) { (ros::serialization::deserialize(stream, part), ...); }, parts);
  } catch (const ros::serialization::StreamOverrunException&) {
    return std::nullopt;
  }
  return parts;
}

template <class Message>
std::optional<DriverPosition> read(const topic_tools::ShapeShifter& message) {
  const auto start = startOf<Message>(message);
  if (!start) return std::nullopt;
  const auto& typed = std::get<Message>(*start);
  DriverPosition found;
  found.position = positionIn(typed);
  if constexpr (traits::HasHeader<Message>::value) found.header = {typed.header.stamp, typed.header.frame_id};
  return found;
}

template <class Message>
std::pair<const std::string, PositionReader> position() {
  return {traits::md5sum<Message>(), read<Message>};
}

/// Buttons as numbers, 1 if held. The CRTK drivers' 2 and 3 tell of clicks that are over.
template <class Numbers>
std::vector<bool> held(const Numbers& numbers) {
  std::vector<bool> buttons;
  for (const auto number : numbers) buttons.push_back(number == 1);
  return buttons;
}

std::vector<bool> buttonsIn(const sensor_msgs::Joy& message) { return held(message.buttons); }
std::vector<bool> buttonsIn(const std_msgs::Int8MultiArray& message) { return held(message.data); }
std::vector<bool> buttonsIn(const std_msgs::Bool& message) { return {message.data != 0}; }
std::vector<bool> buttonsIn(const std::vector<std::uint8_t>& bools) { return held(bools); }
std::vector<bool> buttonsIn(const boost::array<std::int32_t, 2>& numbers) { return held(numbers); }

/// Buttons in the last of the parts.
template <class... Parts>
std::optional<std::vector<bool>> readButtons(const topic_tools::ShapeShifter& message) {
  const auto start = startOf<Parts...>(message);
  if (!start) return std::nullopt;
  return buttonsIn(std::get<sizeof...(Parts) - 1>(*start));
}

template <class Message>
std::pair<const std::string, ButtonReader> buttons() {
  return {traits::md5sum<Message>(), readButtons<Message>};
}

template <class Vector>
void setVector(const Vec3& value, Vector& vector) {
  vector.x = value.x();
  vector.y = value.y();
  vector.z = value.z();
}

void setForce(const Vec3& force, geometry_msgs::Point& message) { setVector(force, message); }
void setForce(const Vec3& force, geometry_msgs::Vector3& message) { setVector(force, message); }
void setForce(const Vec3& force, geometry_msgs::Vector3Stamped& message) { setVector(force, message.vector); }
void setForce(const Vec3& force, geometry_msgs::Twist& message) { setVector(force, message.linear); }
void setForce(const Vec3& force, geometry_msgs::Wrench& message) { setVector(force, message.force); }
void setForce(const Vec3& force, geometry_msgs::WrenchStamped& message) {
  setVector(force, message.wrench.force);
}

template <class Message>
Bytes write(const Vec3& force, const MessageHeader& header) {
  Message message;
  setForce(force, message);
  if constexpr (traits::HasHeader<Message>::value) {
    message.header.stamp = header.stamp;
    message.header.frame_id = header.frame_id;
  }
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// Force and position of OmniFeedback, two vectors as in a Wrench.
Bytes writeOmniFeedback(const Vec3& force, const MessageHeader& header) {
  return write<geometry_msgs::Wrench>(force, header);
}

/// The same and an array of bool. ros_geomagic reads three locks whatever the array's length.
Bytes writeDeviceFeedback(const Vec3& force, const MessageHeader& header) {
  Bytes bytes = writeOmniFeedback(force, header);
  bytes.insert(bytes.end(), {3, 0, 0, 0, 0, 0, 0});
  return bytes;
}

/// Three int16: ros_falcon takes forces in whole newtons.
Bytes writeFalconForces(const Vec3& force, const MessageHeader&) {
  using Limits = std::numeric_limits<std::int16_t>;
  Bytes bytes;
  for (const double value : {force.x(), force.y(), force.z()}) {
    const double held = std::clamp<double>(std::round(value), Limits::min(), Limits::max());
    const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(held));
    bytes.push_back(static_cast<unsigned char>(bits & 0xff));
    bytes.push_back(static_cast<unsigned char>(bits >> 8));
  }
  return bytes;
}

template <class Message>
std::pair<const std::string, ForceType> force() {
  return {traits::datatype<Message>(),
          {traits::md5sum<Message>(), traits::definition<Message>(), write<Message>}};
}

/// Definition of a type with members of type geometry_msgs/Vector3.
std::string withVector(const std::string& members) {
  return members + "===\nMSG: geometry_msgs/Vector3\n" + traits::definition<geometry_msgs::Vector3>();
}

}  // namespace

PositionReader findPositionReader(const std::string& md5sum) {
  static const std::map<std::string, PositionReader> kTypes = {
      position<geometry_msgs::Point>(),  // and Vector3, which has the same sum
      position<geometry_msgs::Pose>(),
      position<geometry_msgs::Twist>(),
      position<geometry_msgs::Transform>(),
      position<geometry_msgs::PointStamped>(),
      position<geometry_msgs::Vector3Stamped>(),
      position<geometry_msgs::PoseStamped>(),
      position<geometry_msgs::TwistStamped>(),
      position<geometry_msgs::TransformStamped>(),
      {kTouchState, read<geometry_msgs::PoseStamped>},
      {kMovingTouchState, read<geometry_msgs::TransformStamped>},
      // falconPos of ros_falcon: a Point whose members are X, Y and Z.
      {"8219583d7802cc50be3e9ab911877ba5", read<geometry_msgs::Point>}};
  const auto entry = kTypes.find(md5sum);
  return entry == kTypes.end() ? nullptr : entry->second;
}

ButtonReader findButtonReader(const std::string& md5sum) {
  using Bools = std::vector<std::uint8_t>;
  static const std::map<std::string, ButtonReader> kTypes = {
      buttons<sensor_msgs::Joy>(),
      buttons<std_msgs::Int8MultiArray>(),
      buttons<std_msgs::Bool>(),
      {kTouchState, readButtons<geometry_msgs::PoseStamped, Bools>},
      {kMovingTouchState, readButtons<geometry_msgs::TransformStamped, geometry_msgs::Twist, Bools>},
      // OmniButtonEvent, DeviceButtonEvent and PhantomButtonEvent: int32 grey_button, int32 white_button.
      {"fb77877e6b639935c3360838062f05f0", readButtons<boost::array<std::int32_t, 2>>}};
  const auto entry = kTypes.find(md5sum);
  return entry == kTypes.end() ? nullptr : entry->second;
}

const ForceType* findForceType(const std::string& datatype) {
  static const std::map<std::string, ForceType> kStandard = {
      force<geometry_msgs::WrenchStamped>(),  force<geometry_msgs::Wrench>(), force<geometry_msgs::Vector3>(),
      force<geometry_msgs::Vector3Stamped>(), force<geometry_msgs::Point>(),  force<geometry_msgs::Twist>()};
  // Types of drivers' own, with the sums that `rosmsg md5` gives.
  static const std::map<std::string, ForceType> kOwn = {
      // phantom_omni and its successors; `position` is where the driver holds a locked tool.
      {"OmniFeedback",
       {"e9083ac4fd95494e94fbb0c0f90b6c00",
        withVector("geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 position\n"), writeOmniFeedback}},
      {"DeviceFeedback",
       {"94755b031db27fe99c2c235c0da9b072",
        withVector("geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 position\nbool[] lock\n"),
        writeDeviceFeedback}},
      {"falconForces",
       {"b4669138e2c3f68ffec8f31ed47c17a1", "int16 X\nint16 Y\nint16 Z\n", writeFalconForces}}};
  const auto standard = kStandard.find(datatype);
  if (standard != kStandard.end()) return &standard->second;
  const auto own = kOwn.find(datatype.substr(datatype.find('/') + 1));
  return own == kOwn.end() ? nullptr : &own->second;
}

}  // namespace haptic_cloth
