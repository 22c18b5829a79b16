/// Requests to end, handled so that the node can still send a last message.
#pragma once

#include <signal.h>

#include <atomic>

namespace haptic_cloth {

/// The signals that ask a process to end, blocked in every thread and waited for in one. A signal handler
/// could not send the last wrench. Ctrl-Z does nothing, because the device would hold the force of a stopped
/// process. Create it before any other thread, with roscpp's own handler disabled.
class Signals {
 public:
  Signals();
  /// @return whether a signal came within `milliseconds` (< 1000)
  bool wait(long milliseconds) const;

 private:
  sigset_t set_;
};

/// Makes the shutdown call set `asked`. `rosnode kill` and the master, when another node takes this
/// name, send that call. roscpp's own handler would close the publishers before the last wrench is
/// sent. Call this before the first NodeHandle, so that roscpp keeps this handler. Once its server
/// runs, a handler can only be changed while the server does not wait, which takes seconds on a
/// busy machine.
void answerShutdownCall(std::atomic<bool>& asked);

/// Ends the process with 0 if it still runs after `seconds`. Without it roscpp could wait for ever
/// for a master that does not answer, even to sign off. Static objects are not destroyed.
void endWithin(double seconds);

/// Waits until the master answers. @return false if a signal came first
bool waitForMaster(const Signals& signals);

}  // namespace haptic_cloth
