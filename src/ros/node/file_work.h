/// Work on files, which may take any time: a file system over a network can stop answering.
#pragma once

#include <functional>

namespace haptic_cloth {

/// Does the work on a thread of its own and waits until it is done, or until a moment after it is
/// called off. A thread that is still at work then is left to itself: nothing can wake it while it
/// waits for the file system.
/// @param work uses nothing but what it owns
/// @param called_off is asked every few milliseconds
/// @return whether the work was done  @throws what the work throws
bool runFileWork(std::function<void()> work, const std::function<bool()>& called_off);

}  // namespace haptic_cloth
