// The choice among the kernels' instruction sets.
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

namespace {

struct Path {
  const char* name;
  const Kernels* kernels;
  bool available;
};

Path choosePath() {
#if HAPTIC_CLOTH_X86
  __builtin_cpu_init();
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  const Path paths[] = {{"avx512", &avx512::table, has_avx512},
                        {"avx2", &avx2::table, has_avx2},
                        {"sse2", &sse2::table, true}};  // best first
#else
  const Path paths[] = {{"baseline", &baseline::table, true}};
#endif
  const char* const wanted = std::getenv("HAPTIC_CLOTH_SIMD");
  std::string names;
  for (const Path& path : paths) {
    if (!path.available) continue;
    if (!wanted || *wanted == '\0' || path.name == std::string(wanted)) return path;
    names += (names.empty() ? "" : ", ") + std::string(path.name);
  }
  for (const Path& path : paths) {
    if (path.name == std::string(wanted)) {
      throw InputError("environment", "HAPTIC_CLOTH_SIMD", wanted,
                       "this machine does not have these instructions; it has " + names);
    }
  }
  throw InputError("environment", "HAPTIC_CLOTH_SIMD", wanted,
                   "no such instruction set; this machine has " + names);
}

const Path& path() {
  static const Path chosen = choosePath();
  return chosen;
}

}  // namespace

const Kernels& kernels() { return *path().kernels; }

const char* instructionSet() { return path().name; }

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
