/// Common main() of the node's programs.
#pragma once

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "haptic_cloth/error.h"
#include "ros/node/shutdown.h"

namespace haptic_cloth {

/// Option for programs that roslaunch restarts whatever their exit status (respawn): with bad input
/// the restarts would never end.
constexpr char kWaitOnBadInput[] = "--wait-on-bad-input";

/// Runs a program; an exception goes to stderr after its name. With kWaitOnBadInput among the
/// arguments, bad input is reported once and the program waits for a signal.
/// @return exit status of `run`; 2: bad input, 1: any other failure
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
