/// Log messages that say why all messages on a topic are dropped.
#pragma once

#include <set>
#include <string>

namespace haptic_cloth {

/// Reports each reason once, after all messages were dropped for a second. A message dropped among
/// good ones, or before tf is available, is only counted.
class DropNotice {
 public:
  /// @param what name of the messages, for example "poses of probe"
  /// @param cloth_frame see NodeOptions::frame_id
  DropNotice(const std::string& what, const std::string& cloth_frame)
      : what_(what), cloth_frame_(cloth_frame) {}

  /// A message was dropped because of its frame. @param now steady clock [s]  @return text to log,
  /// or empty
  std::string unknownFrame(const std::string& frame, double now);

  /// A message was dropped because of its stamp. @param age of the stamp [s]
  std::string late(double age, double max_age, double now);

  /// A message was dropped because another node, `first`, sends them, too. Reported at once.
  std::string otherSender(const std::string& sender, const std::string& first);

  /// A message was dropped because of its values. @param fault what is wrong with them: "not finite"
  std::string unusable(const std::string& fault, double now);

  /// A message was accepted.
  void taken() { since_ = -1.0; }

 private:
  enum class Reason { UnknownFrame, Late, OtherSender, Unusable };
  bool isDue(Reason reason, double now);

  std::string what_, cloth_frame_;
  double since_ = -1.0;  ///< time of the first drop since the last accepted message [s]; < 0: none
  std::set<Reason> said_;
};

/// Logs a warning unless the text is empty.
void warn(const std::string& text);

}  // namespace haptic_cloth
