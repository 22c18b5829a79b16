/// What the main() of each program of the node's does.
#pragma once

#include <cstdio>
#include <exception>

#include "haptic_cloth/error.h"

namespace haptic_cloth {

/// Runs it; what it throws goes to stderr after its name. @return its exit status; 2: bad input, 1: any other
/// failure
inline int runProgram(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace haptic_cloth
