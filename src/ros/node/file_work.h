/// Work on files, which may block: a network file system can stop answering.
#pragma once

#include <functional>

namespace haptic_cloth {

/// Runs the work on a separate thread and waits until it is done, or until 1 s after it is
/// cancelled. A thread that still works then is left behind, because nothing can wake it while it
/// waits for the file system.
/// @param work uses only what it owns
/// @param called_off asked every few milliseconds; true cancels
/// @return whether the work was done  @throws what the work throws
bool runFileWork(std::function<void()> work, const std::function<bool()>& called_off);

}  // namespace haptic_cloth
