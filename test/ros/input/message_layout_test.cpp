/// Messages whose types are known only at run time, compared with roscpp's serialisation and MD5
/// sums.
#include "ros/input/message_layout.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <std_msgs/Float64MultiArray.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>
#include <visualization_msgs/MarkerArray.h>

#include "haptic_cloth/error.h"
#include "ros/input/force_types.h"
#include "ros/input/md5.h"
#include "ros/input/vector_field.h"

namespace haptic_cloth {
namespace {

template <class Message>
MessageLayout layoutOf() {
  return {ros::message_traits::datatype<Message>(), ros::message_traits::definition<Message>()};
}

template <class Message>
std::vector<unsigned char> serialized(const Message& message) {
  std::vector<unsigned char> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <class Message>
Message deserialized(std::vector<unsigned char> bytes) {
  Message message;
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::deserialize(stream, message);
  EXPECT_EQ(stream.getLength(), 0u) << "bytes are left";
  return message;
}

/// The position that is found without a given path.
template <class Message>
Vec3 positionIn(const Message& message) {
  const auto path = findVector(layoutOf<Message>(), positionPaths());
  if (!path) return Vec3::Constant(-1.0);
  return VectorReader(layoutOf<Message>(), *path).read(serialized(message)).value_or(Vec3::Constant(-2.0));
}

/// RFC 1321, appendix 5.
TEST(Md5, TheExamplesOfItsStandard) {
  EXPECT_EQ(md5(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(md5("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(md5("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"),
            "d174ab98d277d9f5a5611c2c9f419d9f");
  EXPECT_EQ(md5("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
            "57edf4a22be3c955ac49da2e2107b67a");
}

template <class Message>
void expectFingerprint() {
  EXPECT_EQ(layoutOf<Message>().fingerprint(), ros::message_traits::md5sum<Message>())
      << ros::message_traits::datatype<Message>();
}

/// MD5 sums of types with headers, constants, arrays, nested arrays and text, compared with those
/// that genmsg wrote into the message headers.
TEST(MessageLayout, FingerprintsAreThoseOfGenmsg) {
  expectFingerprint<geometry_msgs::Vector3>();
  expectFingerprint<geometry_msgs::WrenchStamped>();
  expectFingerprint<geometry_msgs::PoseStamped>();
  expectFingerprint<diagnostic_msgs::DiagnosticArray>();
  expectFingerprint<visualization_msgs::MarkerArray>();
  expectFingerprint<std_msgs::Float64MultiArray>();
  expectFingerprint<ClothState>();
}

/// Expected values from `genmsg.gentools.compute_md5` for the same text.
TEST(MessageLayout, FingerprintsOfDriversOwnTypes) {
  const auto fingerprint = [](const std::string& datatype) {
    const auto type = findForceType(datatype);
    return type ? MessageLayout(type->datatype, type->definition).fingerprint() : "";
  };
  EXPECT_EQ(fingerprint("omni_msgs/OmniFeedback"), "e9083ac4fd95494e94fbb0c0f90b6c00");
  EXPECT_EQ(fingerprint("another_package/OmniFeedback"), "e9083ac4fd95494e94fbb0c0f90b6c00");
  EXPECT_EQ(fingerprint("geomagic_control/DeviceFeedback"), "94755b031db27fe99c2c235c0da9b072");
  EXPECT_EQ(fingerprint("ros_falcon/falconForces"), "b4669138e2c3f68ffec8f31ed47c17a1");
  EXPECT_EQ(fingerprint("nowhere/Unknown"), "");
  const MessageLayout constants(
      "t/K",
      "string NAME= a b # c\nint32 A=7 # why\nbyte B = 3\nfloat64[3] p\nstring[] names\n"
      "duration d\n");
  EXPECT_EQ(constants.fingerprint(), "db8a8cd7f813709562183d56367f06a5");
}

TEST(MessageLayout, BadDefinitionsAreErrors) {
  EXPECT_THROW(MessageLayout("t/A", "t/B b\n"), InputError);
  EXPECT_THROW(MessageLayout("t/A", "t/A a\n"), InputError);
  EXPECT_THROW(MessageLayout("t/A", "t/B b\n===\nMSG: t/B\nt/A a\n"), InputError);
  EXPECT_THROW(MessageLayout("t/A", "float64\n"), InputError);
  EXPECT_THROW(MessageLayout("t/A", "float64[x] a\n"), InputError);
  EXPECT_THROW(MessageLayout("A", "float64 a\n"), InputError);
}

TEST(VectorReader, FindsThePositionInWhatDriversSend) {
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
  geometry_msgs::Twist twist;
  set(twist.linear);
  twist.angular.x = 90.0;
  EXPECT_EQ(positionIn(twist), expected);
  geometry_msgs::TransformStamped transform;
  transform.child_frame_id = "tool";
  set(transform.transform.translation);
  EXPECT_EQ(positionIn(transform), expected);
  visualization_msgs::InteractiveMarkerFeedback marker;
  marker.marker_name = "probe";
  set(marker.pose.position);
  EXPECT_EQ(positionIn(marker), expected);
}

TEST(VectorReader, ReadsForeignTypes) {
  // falconPos has capitals. Its fields are three doubles, as in Point.
  const MessageLayout falcon("ros_falcon/falconPos", "float64 X\nfloat64 Y\nfloat64 Z\n");
  geometry_msgs::Point point;
  point.x = 1.0;
  point.y = 2.0;
  point.z = 3.0;
  EXPECT_EQ(findVector(falcon, positionPaths()), "");
  EXPECT_EQ(VectorReader(falcon, "").read(serialized(point)), Vec3(1, 2, 3));

  // The path leads past text and variable arrays to an array of floats.
  const MessageLayout state(
      "t/State", "string name\nt/Item[] items\nfloat32[3] xyz\n===\nMSG: t/Item\nstring s\nint16 i\n");
  std::vector<unsigned char> bytes = {1, 0, 0, 0, 'n', 1, 0, 0, 0, 2, 0, 0, 0, 'a', 'b', 7, 0};
  const float xyz[3] = {0.5F, 1.5F, -2.5F};
  const auto* raw = reinterpret_cast<const unsigned char*>(xyz);
  for (std::size_t k = 0; k < sizeof xyz; ++k) bytes.push_back(raw[k]);
  const VectorReader reader(state, "xyz");
  EXPECT_EQ(reader.read(bytes), Vec3(0.5, 1.5, -2.5));
  bytes.pop_back();
  EXPECT_FALSE(reader.read(bytes)) << "cut short";
  EXPECT_FALSE(reader.read({255, 255, 255, 255})) << "a length beyond the message";
  EXPECT_THROW(VectorReader(state, "items"), InputError);
  EXPECT_THROW(VectorReader(state, "name"), InputError);
  EXPECT_THROW(VectorReader(state, "items.s"), InputError);
  EXPECT_THROW(VectorReader(state, "nothing.here"), InputError);
  EXPECT_FALSE(findVector(state, positionPaths()));
}

TEST(VectorReader, TheHeaderIsKept) {
  geometry_msgs::Vector3Stamped message;
  message.header.stamp = ros::Time(12, 34);
  message.header.frame_id = "base";
  const VectorReader reader(layoutOf<geometry_msgs::Vector3Stamped>(), "vector");
  EXPECT_EQ(reader.header(serialized(message)).stamp, ros::Time(12, 34));
  EXPECT_EQ(reader.header(serialized(message)).frame_id, "base");
  const VectorReader bare(layoutOf<geometry_msgs::Vector3>(), "");
  EXPECT_TRUE(bare.header(serialized(message.vector)).stamp.isZero());
}

template <class Message>
Message written(const Vec3& force) {
  const auto type = findForceType(ros::message_traits::datatype<Message>());
  if (!type) throw InputError("test", ros::message_traits::datatype<Message>(), "", "is not known");
  const MessageLayout layout(type->datatype, type->definition);
  const VectorWriter writer(layout, findVector(layout, forcePaths()).value(), type->lengths);
  return deserialized<Message>(writer.write(force, {ros::Time(12, 34), "base"}));
}

TEST(VectorWriter, WritesWhatRoscppReads) {
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
}

/// Bytes written by hand from the definitions: three doubles of force, three zeros, a count of 3
/// and three locks of 0.
TEST(VectorWriter, DriversOwnTypesByteForByte) {
  const auto bytes = [](const std::string& datatype, const Vec3& force) {
    const ForceType type = findForceType(datatype).value();
    const MessageLayout layout(type.datatype, type.definition);
    return VectorWriter(layout, findVector(layout, forcePaths()).value(), type.lengths).write(force, {});
  };
  const Vec3 force(1.5, -2.5, 0.25);
  std::vector<unsigned char> expected(6 * sizeof(double));
  std::memcpy(expected.data(), force.data(), 3 * sizeof(double));
  EXPECT_EQ(bytes("omni_msgs/OmniFeedback", force), expected);
  for (const unsigned char byte : {3, 0, 0, 0, 0, 0, 0}) expected.push_back(byte);
  EXPECT_EQ(bytes("geomagic_control/DeviceFeedback", force), expected);
  // Whole newtons, clamped to the range of the type.
  EXPECT_EQ(bytes("ros_falcon/falconForces", Vec3(1.6, -2.4, 1e9)),
            (std::vector<unsigned char>{2, 0, 0xfe, 0xff, 0xff, 0x7f}));
}

TEST(VectorWriter, AnyArrayOfThree) {
  const MessageLayout layout("t/Force", "string note\nfloat64[] force\n");
  const std::vector<unsigned char> bytes = VectorWriter(layout, "force", {}).write(Vec3(1, 2, 3), {});
  EXPECT_EQ(bytes.size(), 4u + 4u + 24u);
  EXPECT_EQ(VectorReader(layout, "force").read(bytes), Vec3(1, 2, 3));
  EXPECT_THROW(VectorWriter(layout, "note", {}), InputError);
}

}  // namespace
}  // namespace haptic_cloth
