/// Signals that end a process which is not ours, as the manager of a nodelet.
#pragma once

#include <functional>
#include <list>

namespace haptic_cloth {

/// While it lives, `rest` is called before SIGINT, SIGTERM or SIGHUP do in this process what they
/// did before: roscpp closes all topics at once, and a driver would hold the last force for ever.
class BeforeSignals {
 public:
  explicit BeforeSignals(std::function<void()> rest);
  /// Waits for `rest` where that is being called.
  ~BeforeSignals();
  BeforeSignals(const BeforeSignals&) = delete;
  BeforeSignals& operator=(const BeforeSignals&) = delete;

 private:
  std::list<std::function<void()>>::iterator place_;
};

}  // namespace haptic_cloth
