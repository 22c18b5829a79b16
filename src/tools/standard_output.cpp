#include "tools/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "haptic_cloth/error.h"

namespace haptic_cloth {

void requireStandardOutput() {
  errno = 0;
  std::cout.flush();
  const bool written = std::fflush(stdout) == 0 && std::cout && std::ferror(stdout) == 0;
  if (!written) throw OutputError("standard output", errno != 0 ? std::strerror(errno) : "");
}

}  // namespace haptic_cloth
