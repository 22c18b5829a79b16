/// How a node is asked to end while it can still send a last message.
#pragma once

#include <signal.h>

#include <atomic>

namespace haptic_cloth {

/// SIGINT, SIGTERM and SIGHUP, blocked in every thread so that this one can wait for them: a handler could
/// not send the last wrench. To be made before any thread, with roscpp's own handler switched off.
class Signals {
 public:
  Signals();
  /// @return whether a signal came within `milliseconds` (< 1000)
  bool wait(long milliseconds) const;

 private:
  sigset_t set_;
};

/// `rosnode kill`, and the master when another node takes this name: sets `asked`. roscpp's own answer would
/// close the publishers before the last wrench is out. To be called before the first NodeHandle:
/// roscpp then keeps this answer. Once its server runs, a thread that wants to change an answer has
/// to catch the moment in which the server does not wait, which takes seconds on a busy machine.
void answerShutdownCall(std::atomic<bool>& asked);

/// Ends the process with 0 after `seconds`, should what follows not have done so: a master that
/// does not answer is waited for without end wherever roscpp asks it for something, also to say
/// goodbye. Static objects stay.
void endWithin(double seconds);

/// Waits until the master answers. @return false if a signal came first
bool waitForMaster(const Signals& signals);

}  // namespace haptic_cloth
