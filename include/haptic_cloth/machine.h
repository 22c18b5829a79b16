/// Description of the machine, to be printed beside every measured time.
#pragma once

#include <string>

namespace haptic_cloth {

/// Instruction set of the kernels in use: "sse2", "avx2", "avx512", or "baseline" if the processor
/// is not an x86. The best of the machine, unless the environment variable HAPTIC_CLOTH_SIMD names
/// another.
/// @throws InputError if that variable names a set that is unknown or that this machine lacks
const char* instructionSet();

/// Name of the processor and number of cores available to this process, for people to read.
std::string processorName();

}  // namespace haptic_cloth
