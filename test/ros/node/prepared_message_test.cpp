/// A prepared message leaves as the message itself would, and publishing it turns nothing into bytes.
#include "ros/display/prepared_message.h"

#include <gtest/gtest.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstring>

namespace haptic_cloth::prepared_message_test {
namespace {

TEST(PreparedMessage, HasTheBytesAndTheTypeOfTheMessage) {
  visualization_msgs::MarkerArray message;
  message.markers.resize(2);
  message.markers[1].ns = "cloth";
  message.markers[1].points.resize(1000);
  const PreparedMessage prepared(message);
  const ros::SerializedMessage expected = ros::serialization::serializeMessage(message),
                               first = ros::serialization::serializeMessage(prepared),
                               second = ros::serialization::serializeMessage(prepared);
  ASSERT_EQ(first.num_bytes, expected.num_bytes);
  EXPECT_EQ(std::memcmp(first.buf.get(), expected.buf.get(), expected.num_bytes), 0);
  EXPECT_EQ(first.buf, second.buf) << "the bytes that were prepared";
  EXPECT_EQ(first.message_start - first.buf.get(), expected.message_start - expected.buf.get());
  namespace traits = ros::message_traits;
  EXPECT_STREQ(traits::md5sum(prepared), traits::md5sum(message));
  EXPECT_STREQ(traits::datatype(prepared), traits::datatype(message));
}

}  // namespace
}  // namespace haptic_cloth::prepared_message_test
