/// Messages of drivers: positions and buttons that are found, forces as bytes. Criteria: roscpp's own
/// serialisation; definitions of the drivers' types, written out by hand.
#include "ros/input/driver_messages.h"

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <sensor_msgs/Joy.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int8MultiArray.h>
#include <std_msgs/String.h>

#include <cstring>

namespace haptic_cloth::driver_messages_test {
namespace {

namespace traits = ros::message_traits;
using Bytes = std::vector<unsigned char>;

/// A message as the adapter gets it.
topic_tools::ShapeShifter received(const std::string& md5sum, Bytes bytes) {
  topic_tools::ShapeShifter message;
  message.morph(md5sum, "any/Type", "", "");
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.read(stream);
  return message;
}

template <class Message>
Bytes serialized(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

std::optional<DriverPosition> find(const std::string& md5sum, const Bytes& bytes) {
  const PositionReader reader = findPositionReader(md5sum);
  return reader ? reader(received(md5sum, bytes)) : std::nullopt;
}

template <class Message>
Vec3 positionIn(const Message& message) {
  const auto found = find(traits::md5sum<Message>(), serialized(message));
  return found ? found->position : Vec3::Constant(-1.0);
}

TEST(DriverMessages, HoldPositions) {
  const Vec3 expected(0.1, -0.2, 0.3);
  const auto set = [&](auto& vector) {
    vector.x = expected.x();
    vector.y = expected.y();
    vector.z = expected.z();
  };
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "a name";
  set(pose.pose.position);
  EXPECT_EQ(positionIn(pose), expected);
  EXPECT_EQ(positionIn(pose.pose), expected);
  EXPECT_EQ(positionIn(pose.pose.position), expected);
  geometry_msgs::PointStamped point;
  set(point.point);
  EXPECT_EQ(positionIn(point), expected);
  geometry_msgs::Vector3Stamped vector;
  set(vector.vector);
  EXPECT_EQ(positionIn(vector), expected);
  EXPECT_EQ(positionIn(vector.vector), expected);
  geometry_msgs::TwistStamped twist;
  set(twist.twist.linear);
  twist.twist.angular.x = 90.0;
  EXPECT_EQ(positionIn(twist), expected);
  EXPECT_EQ(positionIn(twist.twist), expected);
  geometry_msgs::TransformStamped transform;
  transform.child_frame_id = "tool";
  set(transform.transform.translation);
  EXPECT_EQ(positionIn(transform), expected);
  EXPECT_EQ(positionIn(transform.transform), expected);
}

TEST(DriverMessages, HoldStampAndFrame) {
  geometry_msgs::PointStamped message;
  message.header.stamp = ros::Time(12, 34);
  message.header.frame_id = "base";
  const auto found = find(traits::md5sum<geometry_msgs::PointStamped>(), serialized(message));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->header.stamp, ros::Time(12, 34));
  EXPECT_EQ(found->header.frame_id, "base");
  const auto plain = find(traits::md5sum<geometry_msgs::Point>(), serialized(geometry_msgs::Point()));
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->header.stamp.isZero());
}

/// TouchState is "Header header, geometry_msgs/Pose pose, bool[] buttons".
TEST(DriverMessages, WhatFollowsAPositionIsNotRead) {
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "touch";
  pose.pose.position.x = 0.1;
  Bytes bytes = serialized(pose);
  bytes.insert(bytes.end(), {2, 0, 0, 0, 1, 0});  // two buttons
  const auto found = find("882b066d515316daecadf177b58cf445", bytes);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->position, Vec3(0.1, 0.0, 0.0));
  EXPECT_EQ(found->header.frame_id, "touch");
}

/// falconPos is "float64 X, Y, Z"; its sum is that of `rosmsg md5`.
TEST(DriverMessages, FalconsPositionHasCapitals) {
  const Vec3 expected(1, 2, 3);
  Bytes bytes(3 * sizeof(double));
  std::memcpy(bytes.data(), expected.data(), bytes.size());
  const auto found = find("8219583d7802cc50be3e9ab911877ba5", bytes);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->position, expected);
}

using Buttons = std::vector<bool>;

std::optional<Buttons> findButtons(const std::string& md5sum, const Bytes& bytes) {
  const ButtonReader reader = findButtonReader(md5sum);
  return reader ? reader(received(md5sum, bytes)) : std::nullopt;
}

template <class Message>
std::optional<Buttons> buttonsIn(const Message& message) {
  return findButtons(traits::md5sum<Message>(), serialized(message));
}

/// The numbers of a CRTK driver: 0 released, 1 pressed, 2 and 3 clicked, all three after a release.
TEST(DriverMessages, HoldButtons) {
  sensor_msgs::Joy joy;
  joy.header.frame_id = "a name";
  joy.axes = {1.0F, -1.0F};
  joy.buttons = {0, 1, 2, 3};
  EXPECT_EQ(buttonsIn(joy), (Buttons{false, true, false, false}));
  std_msgs::Int8MultiArray array;
  array.layout.dim.resize(1);
  array.data = {1, 0};
  EXPECT_EQ(buttonsIn(array), (Buttons{true, false}));
  std_msgs::Bool one;
  one.data = 1;
  EXPECT_EQ(buttonsIn(one), Buttons{true});
}

/// Bytes written by hand from the definitions; the sums are those that `rosmsg md5` gives.
TEST(DriverMessages, HoldButtonsOfDriversOwnTypes) {
  // OmniButtonEvent: int32 grey_button, int32 white_button.
  EXPECT_EQ(findButtons("fb77877e6b639935c3360838062f05f0", {0, 0, 0, 0, 1, 0, 0, 0}),
            (Buttons{false, true}));
  const Bytes held{2, 0, 0, 0, 1, 0};  // bool[] of two
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "touch";
  Bytes bytes = serialized(pose);
  bytes.insert(bytes.end(), held.begin(), held.end());
  EXPECT_EQ(findButtons("882b066d515316daecadf177b58cf445", bytes), (Buttons{true, false}));
  geometry_msgs::TransformStamped moving;
  moving.child_frame_id = "stylus";
  bytes = serialized(moving);
  bytes.resize(bytes.size() + 6 * sizeof(double));  // twist
  bytes.insert(bytes.end(), held.begin(), held.end());
  EXPECT_EQ(findButtons("30e5c9275c60943d770c087f33b76fac", bytes), (Buttons{true, false}));
}

TEST(DriverMessages, OthersAreNotRead) {
  EXPECT_EQ(findButtonReader(traits::md5sum<geometry_msgs::Point>()), nullptr);
  EXPECT_FALSE(findButtons("fb77877e6b639935c3360838062f05f0", Bytes(7))) << "a byte is missing";
  EXPECT_EQ(findPositionReader(traits::md5sum<std_msgs::String>()), nullptr);
  EXPECT_FALSE(find(traits::md5sum<geometry_msgs::Point>(), Bytes(23))) << "a byte is missing";
  EXPECT_EQ(findForceType("nowhere/Unknown"), nullptr);
}

template <class Message>
Message written(const Vec3& force) {
  const ForceType* type = findForceType(traits::datatype<Message>());
  EXPECT_NE(type, nullptr) << traits::datatype<Message>();
  Message message;
  if (!type) return message;
  EXPECT_STREQ(type->md5sum.c_str(), traits::md5sum<Message>());
  Bytes bytes = type->write(force, {ros::Time(12, 34), "base"});
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::deserialize(stream, message);
  EXPECT_EQ(stream.getLength(), 0u) << "bytes are left";
  return message;
}

TEST(DriverMessages, TakeForces) {
  const Vec3 force(1.5, -2.5, 1.0 / 3.0);
  const auto wrench = written<geometry_msgs::WrenchStamped>(force);
  EXPECT_EQ(wrench.header.stamp, ros::Time(12, 34));
  EXPECT_EQ(wrench.header.frame_id, "base");
  EXPECT_EQ(wrench.wrench.force.x, force.x());
  EXPECT_EQ(wrench.wrench.force.y, force.y());
  EXPECT_EQ(wrench.wrench.force.z, force.z());
  EXPECT_EQ(wrench.wrench.torque.z, 0.0);
  EXPECT_EQ(written<geometry_msgs::Wrench>(force).force.y, force.y());
  EXPECT_EQ(written<geometry_msgs::Vector3>(force).z, force.z());
  EXPECT_EQ(written<geometry_msgs::Vector3Stamped>(force).vector.x, force.x());
  EXPECT_EQ(written<geometry_msgs::Point>(force).y, force.y());
  EXPECT_EQ(written<geometry_msgs::Twist>(force).linear.z, force.z());
}

/// Bytes written by hand from the definitions: three doubles of force, three zeros, a count of 3
/// and three locks of 0.
TEST(DriverMessages, OfDriversOwnTypesByteForByte) {
  const auto bytes = [](const std::string& datatype, const Vec3& force) {
    const ForceType* type = findForceType(datatype);
    return type ? type->write(force, {}) : Bytes();
  };
  const Vec3 force(1.5, -2.5, 0.25);
  Bytes expected(6 * sizeof(double));
  std::memcpy(expected.data(), force.data(), 3 * sizeof(double));
  EXPECT_EQ(bytes("omni_msgs/OmniFeedback", force), expected);
  EXPECT_EQ(bytes("another_package/OmniFeedback", force), expected);
  for (const unsigned char byte : {3, 0, 0, 0, 0, 0, 0}) expected.push_back(byte);
  EXPECT_EQ(bytes("geomagic_control/DeviceFeedback", force), expected);
  // Whole newtons, clamped to the range of the type.
  EXPECT_EQ(bytes("ros_falcon/falconForces", Vec3(1.6, -2.4, 1e9)), (Bytes{2, 0, 0xfe, 0xff, 0xff, 0x7f}));
}

}  // namespace
}  // namespace haptic_cloth::driver_messages_test
