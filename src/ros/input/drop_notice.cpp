#include "ros/input/drop_notice.h"

#include <ros/console.h>

#include <cstdio>

namespace haptic_cloth {
namespace {

constexpr double kPatience = 1.0;  ///< time in which all messages were dropped [s]

}  // namespace

bool DropNotice::isDue(Reason reason, double now) {
  if (since_ < 0.0) since_ = now;
  return now - since_ >= kPatience && said_.insert(reason).second;
}

std::string DropNotice::unknownFrame(const std::string& frame, double now) {
  if (!isDue(Reason::UnknownFrame, now)) return "";
  return "all " + what_ + " are dropped: they are in '" + frame + "', and tf has no way from there to '" +
         cloth_frame_ +
         "'. Broadcast it or correct frame_id; device/use_tf: false takes a device's as they are";
}

std::string DropNotice::late(double age, double max_age, double now) {
  if (!isDue(Reason::Late, now)) return "";
  char times[100];
  std::snprintf(times, sizeof times, "%.3g s old, max_pose_age is %.3g s", age, max_age);
  return "all " + what_ + " are dropped: their stamps are " + times +
         ". Set it to 0 for a recording; a stamp of zero is always taken";
}

std::string DropNotice::otherSender(const std::string& sender, const std::string& first) {
  if (!said_.insert(Reason::OtherSender).second) return "";  // the diagnostics continue to count
  return what_ + " from " + sender + " are dropped as long as " + first + " sends, too";
}

std::string DropNotice::unusable(const std::string& fault, double now) {
  if (!isDue(Reason::Unusable, now)) return "";
  return "all " + what_ + " are dropped: they are " + fault;
}

void warn(const std::string& text) {
  if (!text.empty()) ROS_WARN_STREAM(text);
}

}  // namespace haptic_cloth
