/// Numbers as text, independent of the locale, which a host program may have set.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace haptic_cloth {

/// Decimal text of a number with six significant digits, or as many more as it takes to read back
/// the same double: different numbers look different. std::to_chars does this, but is missing in
/// the libraries of gcc 9 and 10.
std::string shortestText(double value);

/// Reads a finite decimal number in YAML's spelling; empty: the text is something else.
std::optional<double> readNumber(const std::string& text);

/// 16 hexadecimal digits.
std::string hexadecimalText(std::uint64_t value);

}  // namespace haptic_cloth
