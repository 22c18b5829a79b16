/// Message types in which drivers send positions and buttons and take forces.
#pragma once

#include <ros/time.h>
#include <topic_tools/shape_shifter.h>

#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Stamp and frame of a message; zero and empty if it has no header.
struct MessageHeader {
  ros::Time stamp;
  std::string frame_id;
};

struct DriverPosition {
  MessageHeader header;
  Vec3 position;
};

/// @return empty if the bytes are not such a message
using PositionReader = std::optional<DriverPosition> (*)(const topic_tools::ShapeShifter& message);

/// Reader for a type that holds a position; nullptr for any other type.
/// @param md5sum of the type: it names the layout, whatever package a fork has moved it to
PositionReader findPositionReader(const std::string& md5sum);

/// @return whether each button is held; empty if the bytes are not such a message
using ButtonReader = std::optional<std::vector<bool>> (*)(const topic_tools::ShapeShifter& message);

/// Reader for a type that holds buttons; nullptr for any other type.
/// @param md5sum as for findPositionReader()
ButtonReader findButtonReader(const std::string& md5sum);

/// Message type that takes a force.
struct ForceType {
  std::string md5sum;
  std::string definition;  ///< as in a connection header
  /// A message as bytes; all but the force and the header is zero.
  std::vector<unsigned char> (*write)(const Vec3& force, const MessageHeader& header);
};

/// Type with this name; nullptr if it is not known. For a driver's own type only the part after the
/// slash counts, because forks of a driver move it between packages.
const ForceType* findForceType(const std::string& datatype);

}  // namespace haptic_cloth
