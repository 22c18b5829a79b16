/// What the main() of each program of the node's does.
#pragma once

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "haptic_cloth/error.h"
#include "ros/node/shutdown.h"

namespace haptic_cloth {

/// For programs that roslaunch starts anew whenever they end (respawn), whatever their exit status: bad input
/// would be bad again, without end.
constexpr char kWaitOnBadInput[] = "--wait-on-bad-input";

/// Runs it; what it throws goes to stderr after its name. With kWaitOnBadInput among the arguments bad input
/// is said once, and the program then waits for a signal. @return its exit status; 2: bad input, 1: any other
/// failure
inline int runProgram(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    const bool waits = std::any_of(
        argv + 1, argv + argc, [](const char* argument) { return argument == std::string(kWaitOnBadInput); });
    if (waits) {
      std::fprintf(stderr, "%s: waiting to be ended; with that put right, launch it again\n", name);
      const Signals signals;
      while (!signals.wait(500)) {
      }
    }
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace haptic_cloth
