/// Large messages that do not keep the haptic thread waiting.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <string>

namespace haptic_cloth {

/// A message in the bytes that leave the process. roscpp turns a message into bytes while it holds a lock
/// that each publish() of the process takes, also that of a force.
class PreparedMessage {
 public:
  template <class M>
  explicit PreparedMessage(const M& message)
      : bytes_(ros::serialization::serializeMessage(message)),
        md5sum_(ros::message_traits::md5sum(message)),
        datatype_(ros::message_traits::datatype(message)) {}

  const ros::SerializedMessage& bytes() const { return bytes_; }
  const std::string& md5sum() const { return md5sum_; }
  const std::string& datatype() const { return datatype_; }

 private:
  ros::SerializedMessage bytes_;
  std::string md5sum_, datatype_;
};

}  // namespace haptic_cloth

// What ros::Publisher::publish() asks of a message.
namespace ros {
namespace message_traits {

template <>
struct MD5Sum<haptic_cloth::PreparedMessage> {
  static const char* value(const haptic_cloth::PreparedMessage& message) { return message.md5sum().c_str(); }
};

template <>
struct DataType<haptic_cloth::PreparedMessage> {
  static const char* value(const haptic_cloth::PreparedMessage& message) {
    return message.datatype().c_str();
  }
};

}  // namespace message_traits
namespace serialization {

template <>
inline SerializedMessage serializeMessage(const haptic_cloth::PreparedMessage& message) {
  return message.bytes();
}

}  // namespace serialization
}  // namespace ros
