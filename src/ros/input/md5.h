/// MD5 (RFC 1321), the fingerprint by which ROS tells message types apart. Not for secrets.
#pragma once

#include <string>

namespace haptic_cloth {

/// 32 lower-case hexadecimal digits.
std::string md5(const std::string& text);

}  // namespace haptic_cloth
