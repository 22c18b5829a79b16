#include "ros/input/md5.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace haptic_cloth {
namespace {

using Words = std::array<std::uint32_t, 4>;

/// Left rotations of the four rounds (RFC 1321, 3.4).
constexpr int kRotations[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};

std::uint32_t rotated(std::uint32_t word, int by) { return (word << by) | (word >> (32 - by)); }

/// Digests one block of 64 bytes.
void digest(const unsigned char* block, Words& state) {
  std::array<std::uint32_t, 16> input;
  for (std::uint32_t k = 0; k < 16; ++k) {
    const unsigned char* bytes = block + 4 * k;
    input[k] = bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
  }
  auto [a, b, c, d] = state;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const std::uint32_t round = i / 16;
    const std::uint32_t mixed = round == 0   ? (b & c) | (~b & d)
                                : round == 1 ? (d & b) | (~d & c)
                                : round == 2 ? b ^ c ^ d
                                             : c ^ (b | ~d);
    const std::uint32_t at = round == 0   ? i
                             : round == 1 ? (5 * i + 1) % 16
                             : round == 2 ? (3 * i + 5) % 16
                                          : (7 * i) % 16;
    const auto sine = static_cast<std::uint32_t>(std::floor(std::abs(std::sin(i + 1.0)) * 4294967296.0));
    const std::uint32_t next = b + rotated(a + mixed + sine + input[at], kRotations[round][i % 4]);
    a = d;
    d = c;
    c = b;
    b = next;
  }
  state = {state[0] + a, state[1] + b, state[2] + c, state[3] + d};
}

}  // namespace

std::string md5(const std::string& text) {
  std::string padded = text + '\x80';
  while (padded.size() % 64 != 56) padded += '\0';
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(text.size());
  for (int k = 0; k < 8; ++k) padded += static_cast<char>(bits >> (8 * k) & 0xff);

  Words state = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  for (std::size_t at = 0; at < padded.size(); at += 64) {
    digest(reinterpret_cast<const unsigned char*>(padded.data()) + at, state);
  }
  std::string digits;
  for (const std::uint32_t word : state) {
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t byte = word >> (8 * k) & 0xff;
      digits += "0123456789abcdef"[byte / 16];
      digits += "0123456789abcdef"[byte % 16];
    }
  }
  return digits;
}

}  // namespace haptic_cloth
