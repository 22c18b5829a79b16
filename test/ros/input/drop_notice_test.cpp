/// Log messages about a device whose messages are all dropped: after a second, once per reason.
#include "ros/input/drop_notice.h"

#include <gtest/gtest.h>

namespace haptic_cloth::drop_notice_test {
namespace {

TEST(DropNotice, SaysAReasonOnceAfterASecondInWhichAllWereDropped) {
  DropNotice notice("poses of thumb", "world");
  EXPECT_EQ(notice.unknownFrame("base", 10.0), "");
  EXPECT_EQ(notice.unknownFrame("base", 10.9), "") << "tf may still be on its way";
  const std::string text = notice.unknownFrame("base", 11.0);
  for (const char* word : {"poses of thumb", "'base'", "'world'", "device/use_tf"})
    EXPECT_NE(text.find(word), std::string::npos) << text;
  EXPECT_EQ(notice.unknownFrame("base", 20.0), "") << "once";
  EXPECT_NE(notice.late(160.0, 0.2, 21.0).find("160 s old, max_pose_age is 0.2 s"), std::string::npos);
  EXPECT_EQ(notice.late(160.0, 0.2, 22.0), "");
}

TEST(DropNotice, MessagesDroppedAmongGoodOnesAreNotSaid) {
  DropNotice notice("poses of thumb", "world");
  for (double now = 10.0; now < 20.0; now += 0.5) {
    EXPECT_EQ(notice.late(1.0, 0.2, now), "");
    notice.taken();
  }
}

TEST(DropNotice, NamesASecondSenderOnce) {
  DropNotice notice("forces of arm", "world");
  EXPECT_EQ(notice.otherSender("/second", "/first"),
            "forces of arm from /second are dropped as long as /first sends, too");
  EXPECT_EQ(notice.otherSender("/second", "/first"), "");
}

}  // namespace
}  // namespace haptic_cloth::drop_notice_test
