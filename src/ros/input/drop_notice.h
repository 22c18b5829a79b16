/// Why nothing of a device is taken, in words for the log.
#pragma once

#include <set>
#include <string>

namespace haptic_cloth {

/// Says a reason once, after a second in which all messages were dropped: one that is dropped among good
/// ones, or before tf has come, is only counted.
class DropNotice {
 public:
  /// @param what is dropped, as "poses of probe"  @param cloth_frame see NodeOptions::frame_id
  DropNotice(const std::string& what, const std::string& cloth_frame)
      : what_(what), cloth_frame_(cloth_frame) {}

  /// One message was dropped for its frame. @param now steady clock [s]  @return what to say, or nothing
  std::string unknownFrame(const std::string& frame, double now);

  /// One was dropped for its stamp. @param age of the stamp [s]
  std::string late(double age, double max_age, double now);

  /// One was taken.
  void taken() { since_ = -1.0; }

 private:
  enum class Reason { UnknownFrame, Late };
  bool isDue(Reason reason, double now);

  std::string what_, cloth_frame_;
  double since_ = -1.0;  ///< of the first dropped since one was taken [s]; < 0: none
  std::set<Reason> said_;
};

/// Warns in the log; of an empty text nothing.
void warn(const std::string& text);

}  // namespace haptic_cloth
