/// Signals that end a process of others, such as the manager of a nodelet.
#pragma once

#include <functional>
#include <list>

namespace haptic_cloth {

/// During its lifetime `rest` is called before SIGINT, SIGTERM, SIGHUP or SIGQUIT have their former effect
/// in this process. In roscpp that effect closes all topics at once, and a driver would hold the
/// last force for ever.
class BeforeSignals {
 public:
  explicit BeforeSignals(std::function<void()> rest);
  /// Waits for `rest` if it is running.
  ~BeforeSignals();
  BeforeSignals(const BeforeSignals&) = delete;
  BeforeSignals& operator=(const BeforeSignals&) = delete;

 private:
  std::list<std::function<void()>>::iterator place_;
};

}  // namespace haptic_cloth
