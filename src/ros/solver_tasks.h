/// Work that a service has done on the solver thread, between two steps.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>

namespace haptic_cloth {

class SolverLoop;

class SolverTasks {
 public:
  using Work = std::function<void(SolverLoop&)>;

  /// Waits until the work is done and rethrows what it throws. One thread calls it.
  /// @param stop the solver ends  @param patience [s]
  /// @return false where it was not begun in time; then it never will be
  bool run(const Work& work, const std::atomic<bool>& stop, double patience);

  /// The solver thread, between two steps: what is waiting. Costs one look where nothing is.
  void work(SolverLoop& loop);

 private:
  std::atomic<bool> waiting_{false};
  std::mutex mutex_;  ///< held while the work is done
  std::condition_variable done_;
  const Work* work_ = nullptr;
  std::exception_ptr error_;
};

}  // namespace haptic_cloth
