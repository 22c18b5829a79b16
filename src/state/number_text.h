/// Text of numbers in messages.
#pragma once

#include <cstdint>
#include <string>

namespace haptic_cloth {

/// Decimal text of a number with six significant digits, or as many more as it takes to read back
/// the same double: different numbers look different. std::to_chars does this, but is missing in
/// the libraries of gcc 9 and 10.
std::string shortestText(double value);

/// 16 hexadecimal digits.
std::string hexadecimalText(std::uint64_t value);

}  // namespace haptic_cloth
