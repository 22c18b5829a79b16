/// Tasks of services that run on the solver thread between two steps.
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

  /// Waits until the work is done and rethrows its exception. Any thread may call it.
  /// @param stop set if the solver ends  @param patience longest wait for the current step to end [s]
  /// @return false if the work was not started in time; then it never will be
  bool run(const Work& work, const std::atomic<bool>& stop, double patience = 5.0);

  /// Called by the solver thread between two steps: runs the waiting tasks. Costs one atomic read
  /// if there are none.
  void work(SolverLoop& loop);

 private:
  struct Task {
    const Work& work;
    bool done = false;
    std::exception_ptr error;
  };

  std::atomic<bool> waiting_{false};
  std::mutex mutex_;  ///< held while tasks run
  std::condition_variable done_;
  std::deque<Task*> tasks_;  ///< not yet done
};

}  // namespace haptic_cloth
