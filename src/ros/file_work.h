/// Work on files, which may take any time: a file system over a network can stop answering.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace haptic_cloth {

/// Does the work on a thread of its own and waits for it, or until a moment after `stop` is set. A thread
/// that is still at work then is left to itself: nothing can wake it while it waits for the file system.
/// @param work uses nothing but what it owns
/// @return what the work returns
/// @throws what the work throws, and std::runtime_error where `stop` came first
std::string runFileWork(std::function<std::string()> work, const std::atomic<bool>& stop);

}  // namespace haptic_cloth
