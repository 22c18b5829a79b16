/// MD5 (RFC 1321), the checksum by which ROS distinguishes message types. Not for security.
#pragma once

#include <string>

namespace haptic_cloth {

/// Checksum as 32 lower-case hexadecimal digits.
std::string md5(const std::string& text);

}  // namespace haptic_cloth
