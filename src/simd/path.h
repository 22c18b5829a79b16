/// Choice among the instruction sets that the kernels were compiled for.
#pragma once

#include <string>
#include <vector>

namespace haptic_cloth {

struct Kernels;

/// Kernels of one instruction set.
struct SimdPath {
  std::string name;
  const Kernels* kernels;
  bool available;  ///< this machine has its instructions
};

/// All paths of this build, best first.
std::vector<SimdPath> simdPaths();

/// First available path, or the one that is named.
/// @param wanted value of HAPTIC_CLOTH_SIMD; null or empty: not set
/// @throws InputError if no path has this name or this machine lacks its instructions
const SimdPath& choosePath(const std::vector<SimdPath>& paths, const char* wanted);

}  // namespace haptic_cloth
