/// The choice among the instruction sets that kernels were compiled for.
#pragma once

#include <string>
#include <vector>

namespace haptic_cloth {

struct Kernels;

/// Kernels of one instruction set.
struct SimdPath {
  std::string name;
  const Kernels* kernels;
  bool available;  ///< this machine has the instructions
};

/// All that this build has, best first.
std::vector<SimdPath> simdPaths();

/// The first available path, or the one that is named.
/// @param wanted value of HAPTIC_CLOTH_SIMD; null or empty: not set
/// @throws InputError where no path has this name, or this machine lacks its instructions
const SimdPath& choosePath(const std::vector<SimdPath>& paths, const char* wanted);

}  // namespace haptic_cloth
