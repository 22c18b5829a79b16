/// Access to three numbers in a message whose type is known only at run time.
#pragma once

#include <ros/time.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/types.h"
#include "ros/input/message_layout.h"

namespace haptic_cloth {

/// First of `candidates` that leads to three numbers; an empty path is the message itself. A path
/// is dotted: "pose.position". Three numbers are a member with x, y and z (in either case), or an
/// array.
std::optional<std::string> findVector(const MessageLayout& layout,
                                      const std::vector<std::string>& candidates);

/// Paths of positions in common messages: PoseStamped and others with a `pose`, Pose,
/// Vector3Stamped, PointStamped, Twist, Transform, TransformStamped, and messages with x, y, z as
/// members.
const std::vector<std::string>& positionPaths();

/// Paths of forces in common messages: WrenchStamped, Wrench and feedback types of drivers,
/// Vector3Stamped, Twist, and messages with x, y, z as members.
const std::vector<std::string>& forcePaths();

/// Stamp and frame of a message that has a header.
struct MessageHeader {
  ros::Time stamp;
  std::string frame_id;
};

/// Reads three numbers.
class VectorReader {
 public:
  /// @throws InputError if `path` does not lead to three numbers
  VectorReader(const MessageLayout& layout, const std::string& path);

  /// @return empty if the bytes are not such a message
  std::optional<Vec3> read(const std::vector<unsigned char>& bytes) const;

  /// Header of the message; zero stamp and empty frame if it has none.
  MessageHeader header(const std::vector<unsigned char>& bytes) const;

 private:
  MessageLayout layout_;
  std::map<std::string, int> wanted_;  ///< path of a number → its index, 0 to 2
};

/// Writes a message that is zero except for three numbers.
class VectorWriter {
 public:
  /// @param lengths lengths of variable arrays, by path; other variable arrays stay empty
  /// @throws InputError if `path` does not lead to three numbers
  VectorWriter(const MessageLayout& layout, const std::string& path,
               const std::map<std::string, int>& lengths);

  /// The message as bytes. @param header used if the type has a header
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
  std::map<std::string, int> wanted_;  ///< path of a number → its index, 0 to 2
  std::vector<unsigned char> zero_;    ///< bytes of the message after its header
  Target targets_[3];
};

}  // namespace haptic_cloth
