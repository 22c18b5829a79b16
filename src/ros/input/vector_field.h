/// Three numbers somewhere in a message of a type known only at run time.
#pragma once

#include <ros/time.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/types.h"
#include "ros/input/message_layout.h"

namespace haptic_cloth {

/// The first of `candidates` that leads to three numbers, empty for the message itself.
/// A path is dotted: "pose.position". Three numbers are a member with x, y and z (in either case), or an
/// array.
std::optional<std::string> findVector(const MessageLayout& layout,
                                      const std::vector<std::string>& candidates);

/// Where positions stand in messages that devices send: PoseStamped and all with a `pose`, Pose,
/// Vector3Stamped, PointStamped, Twist, TransformStamped, and Vector3, Point and all with x, y, z themselves.
const std::vector<std::string>& positionPaths();

/// Where forces stand in messages that devices take: WrenchStamped, Wrench and feedbacks, Vector3Stamped,
/// Vector3.
const std::vector<std::string>& forcePaths();

/// What a message begins with, if it has a header.
struct MessageHeader {
  ros::Time stamp;
  std::string frame_id;
};

/// Reads three numbers.
class VectorReader {
 public:
  /// @throws InputError if `path` does not lead to three numbers
  VectorReader(const MessageLayout& layout, const std::string& path);

  /// @return nothing if the bytes are not such a message
  std::optional<Vec3> read(const std::vector<unsigned char>& bytes) const;

  /// Zero stamp and no name for messages without header.
  MessageHeader header(const std::vector<unsigned char>& bytes) const;

 private:
  MessageLayout layout_;
  std::map<std::string, int> wanted_;  ///< path of a number → which of the three it is
};

/// Writes a message that is zero but for three numbers.
class VectorWriter {
 public:
  /// @param lengths of arrays of variable length, by path; the others stay empty
  /// @throws InputError if `path` does not lead to three numbers
  VectorWriter(const MessageLayout& layout, const std::string& path,
               const std::map<std::string, int>& lengths);

  /// The message as bytes. @param header of messages that have one
  std::vector<unsigned char> write(const Vec3& value, const MessageHeader& header) const;

 private:
  struct Target {
    std::string type;
    std::size_t offset = 0;
  };
  void append(const std::string& type, const std::string& path, const std::map<std::string, int>& lengths,
              const MessageLayout& layout);
  void appendElements(const MessageField& field, const std::string& path,
                      const std::map<std::string, int>& lengths, const MessageLayout& layout);

  bool has_header_;
  std::map<std::string, int> wanted_;  ///< path of a number → which of the three it is
  std::vector<unsigned char> zero_;    ///< the message after its header
  Target targets_[3];
};

}  // namespace haptic_cloth
