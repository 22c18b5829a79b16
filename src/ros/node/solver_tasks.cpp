#include "ros/node/solver_tasks.h"

#include <algorithm>
#include <chrono>

#include "ros/node/steady_clock.h"

namespace haptic_cloth {

bool SolverTasks::run(const Work& work, const std::atomic<bool>& stop, double patience) {
  // Interval at which the end of the solver is checked.
  constexpr std::chrono::milliseconds kLook(10);
  Task task{work, false, nullptr};
  const double give_up = steadyNow() + patience;
  std::unique_lock<std::mutex> lock(mutex_);
  tasks_.push_back(&task);
  waiting_ = true;
  while (!task.done && !stop && steadyNow() < give_up) done_.wait_for(lock, kLook);
  if (!task.done) tasks_.erase(std::find(tasks_.begin(), tasks_.end(), &task));
  if (task.error) std::rethrow_exception(task.error);
  return task.done;
}

void SolverTasks::work(SolverLoop& loop) {
  if (!waiting_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Task* task : tasks_) {
    try {
      task->work(loop);
    } catch (...) {
      task->error = std::current_exception();
    }
    task->done = true;
  }
  tasks_.clear();
  waiting_ = false;
  done_.notify_all();
}

}  // namespace haptic_cloth
