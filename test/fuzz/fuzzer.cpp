/// Entry point for libFuzzer. There is one program per reader; HAPTIC_CLOTH_FUZZED is its function.
/// An exception ends the program, and libFuzzer keeps the input.
#include <cstddef>
#include <cstdint>

#include "fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  haptic_cloth::HAPTIC_CLOTH_FUZZED(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
