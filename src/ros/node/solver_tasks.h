/// Work that services have done on the solver thread, between two steps.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>

namespace haptic_cloth {

class SolverLoop;

class SolverTasks {
 public:
  using Work = std::function<void(SolverLoop&)>;

  /// Waits until the work is done and rethrows what it throws. Any thread may call it.
  /// @param stop the solver ends  @param patience [s]
  /// @return false where it was not begun in time; then it never will be
  bool run(const Work& work, const std::atomic<bool>& stop, double patience);

  /// The solver thread, between two steps: does what is waiting. Costs one look where nothing is.
  void work(SolverLoop& loop);

 private:
  struct Task {
    const Work& work;
    bool done = false;
    std::exception_ptr error;
  };

  std::atomic<bool> waiting_{false};
  std::mutex mutex_;  ///< held while the work is done
  std::condition_variable done_;
  std::deque<Task*> tasks_;  ///< not yet done
};

}  // namespace haptic_cloth
