// Choice of the kernels' instruction set.
#include "simd/path.h"

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "simd/kernels.h"

namespace haptic_cloth {

#if HAPTIC_CLOTH_X86
namespace sse2 {
extern const Kernels table;
}
namespace avx2 {
extern const Kernels table;
}
namespace avx512 {
extern const Kernels table;
}
#else
namespace baseline {
extern const Kernels table;
}
#endif

std::vector<SimdPath> simdPaths() {
#if HAPTIC_CLOTH_X86
  __builtin_cpu_init();
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512bw");
  return {
      {"avx512", &avx512::table, has_avx512}, {"avx2", &avx2::table, has_avx2}, {"sse2", &sse2::table, true}};
#else
  return {{"baseline", &baseline::table, true}};
#endif
}

const SimdPath& choosePath(const std::vector<SimdPath>& paths, const char* wanted) {
  const bool any = !wanted || *wanted == '\0';
  bool known = false;
  std::string names;
  for (const SimdPath& path : paths) {
    const bool named = !any && path.name == wanted;
    if (path.available && (any || named)) return path;
    known = known || named;
    if (path.available) names += (names.empty() ? "" : ", ") + path.name;
  }
  throw InputError("environment", "HAPTIC_CLOTH_SIMD", wanted,
                   (known ? "this machine lacks these instructions; it has "
                          : "no such instruction set; this machine has ") +
                       names);
}

namespace {

const SimdPath& path() {
  static const std::vector<SimdPath> paths = simdPaths();
  static const SimdPath& chosen = choosePath(paths, std::getenv("HAPTIC_CLOTH_SIMD"));
  return chosen;
}

}  // namespace

const Kernels& kernels() { return *path().kernels; }

const char* instructionSet() { return path().name.c_str(); }

std::string processorName() {
  std::string name = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.compare(0, 10, "model name") != 0 || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

}  // namespace haptic_cloth
