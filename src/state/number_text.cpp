#include "state/number_text.h"

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <limits>
#include <locale>
#include <sstream>

namespace haptic_cloth {
namespace {

std::string text(double value, int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

}  // namespace

std::string shortestText(double value) {
  // With fewer digits 400 would become 4e+02.
  constexpr int kUsual = 6, kEnough = std::numeric_limits<double>::max_digits10;
  for (int digits = kUsual; digits < kEnough && std::isfinite(value); ++digits) {
    const std::string shorter = text(value, digits);
    if (readNumber(shorter) == value) return shorter;
  }
  return text(value, kEnough);
}

std::optional<double> readNumber(const std::string& text) {
  constexpr char kDigits[] = "0123456789", kAllowed[] = "0123456789+-.eE";
  if (text.find_first_of(kDigits) == std::string::npos) return {};
  if (text.find_first_not_of(kAllowed) != std::string::npos) return {};
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> value) || !stream.eof() || !std::isfinite(value)) return {};
  return value;
}

std::string hexadecimalText(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, value);
  return text;
}

}  // namespace haptic_cloth
