/// Numbers in messages.
#pragma once

#include <string>

namespace haptic_cloth {

/// The decimal number with the fewest digits, but up to six in any case, that reads back as the
/// same double: two numbers that differ look different. std::to_chars does this, but not in the
/// libraries of gcc 9 and 10.
std::string shortestText(double value);

}  // namespace haptic_cloth
