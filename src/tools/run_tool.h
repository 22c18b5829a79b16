/// Common main() of the programs without ROS.
#pragma once

#include <csignal>
#include <exception>
#include <iostream>

#include "haptic_cloth/error.h"
#include "tools/command_line.h"

namespace haptic_cloth {

enum ExitCode { kSuccess = 0, kBadInput = 2, kFailed = 3, kNotWritten = 4 };

/// Runs a program; an exception goes to stderr. @return exit status
inline int runTool(const char* name, int (*run)(int, char**), int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // the limit of a file's size is an error like a full disk
  std::signal(SIGPIPE, SIG_IGN);  // so is a reader that has gone
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    std::cerr << name << ": " << error.what() << " (see --help)" << std::endl;
    return kBadInput;
  } catch (const InputError& error) {
    std::cerr << error.what() << std::endl;
    return kBadInput;
  } catch (const OutputError& error) {
    std::cerr << name << ": " << error.what() << std::endl;
    return kNotWritten;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << std::endl;
    return kFailed;
  }
}

}  // namespace haptic_cloth
