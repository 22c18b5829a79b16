/// Hash of bytes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace haptic_cloth {

/// FNV-1a, 64 bit.
class ByteHash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* from = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < bytes; ++k) value_ = (value_ ^ from[k]) * 1099511628211ull;
  }

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

}  // namespace haptic_cloth
