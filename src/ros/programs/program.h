/// Common main() of the node's programs.
#pragma once

#include <ros/init.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "ros/node/shutdown.h"

namespace haptic_cloth {

/// Option for programs that roslaunch restarts whatever their exit status (respawn): with bad input
/// the restarts would never end.
constexpr char kWaitOnBadInput[] = "--wait-on-bad-input";

/// Makes SIGTERM end a program as Ctrl-C does, so that the ROS master forgets it. For programs that send no
/// force; call it after ros::init().
inline void endOnSigterm() {
  std::signal(SIGTERM, [](int) { ros::requestShutdown(); });
}

/// Reads the arguments besides those of ROS. @return whether to run; false: the usage was printed
/// @throws InputError for an unknown argument
inline bool readArguments(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  const std::string usage =
      "usage: " + arguments[0] + " [_PARAMETER:=VALUE ...] [NAME:=OTHER_NAME ...] [" + kWaitOnBadInput + "]";
  for (std::size_t k = 1; k < arguments.size(); ++k) {
    if (arguments[k] == "-h" || arguments[k] == "--help") {
      std::puts(usage.c_str());
      return false;
    }
    if (arguments[k] != kWaitOnBadInput)
      throw InputError("command line", arguments[k], "", "unknown argument; " + usage);
  }
  return true;
}

/// Runs a program; an exception goes to stderr after its name. With kWaitOnBadInput among the
/// arguments, bad input is reported once and the program waits for a signal.
/// @return exit status of `run`; 2: bad input, 1: any other failure
inline int runProgram(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return readArguments(argc, argv) ? run(argc, argv) : 0;
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
