/// libFuzzer's entry; one program for each reader, HAPTIC_CLOTH_FUZZED its function. What it throws ends the
/// program, and libFuzzer keeps the input.
#include <cstddef>
#include <cstdint>

#include "fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  haptic_cloth::HAPTIC_CLOTH_FUZZED(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
