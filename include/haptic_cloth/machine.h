/// The machine that the solver runs on: what belongs beside every figure of time.
#pragma once

#include <string>

namespace haptic_cloth {

/// Instruction set of the kernels in use: "sse2", "avx2", "avx512", or "baseline" where the processor is no
/// x86. The machine's best, or what the environment variable HAPTIC_CLOTH_SIMD names.
/// @throws InputError where that names a set that is unknown, or that this machine does not have
const char* instructionSet();

/// The processor's name and its number of cores that this process may use, for people to read.
std::string processorName();

}  // namespace haptic_cloth
