#include "ros/solver_tasks.h"

#include <chrono>
#include <utility>

#include "ros/steady_clock.h"

namespace haptic_cloth {

bool SolverTasks::run(const Work& work, const std::atomic<bool>& stop, double patience) {
  constexpr std::chrono::milliseconds kLook(10);  // for the end of the solver
  std::unique_lock<std::mutex> lock(mutex_);
  work_ = &work;
  waiting_ = true;
  const double give_up = steadyNow() + patience;
  while (work_ != nullptr && !stop && steadyNow() < give_up) done_.wait_for(lock, kLook);
  waiting_ = false;
  const bool begun = std::exchange(work_, nullptr) == nullptr;
  if (std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
  return begun;
}

void SolverTasks::work(SolverLoop& loop) {
  if (!waiting_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (work_ == nullptr) return;
  try {
    (*work_)(loop);
  } catch (...) {
    error_ = std::current_exception();
  }
  work_ = nullptr;
  waiting_ = false;
  done_.notify_one();
}

}  // namespace haptic_cloth
