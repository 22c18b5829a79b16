#include "ros/node/file_work.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

/// Extra wait for a file that is nearly written, after the call is cancelled [s].
constexpr double kLastWait = 1.0;
constexpr std::chrono::milliseconds kLook(10);  ///< interval at which cancellation is checked

/// Result of the work. Both threads own it, because either may end last.
struct Outcome {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr error;
};

void doWork(const std::function<void()>& work, Outcome& outcome) {
  std::exception_ptr error;
  try {
    work();
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard<std::mutex> lock(outcome.mutex);
  outcome.error = error;
  outcome.done = true;
  outcome.changed.notify_one();
}

}  // namespace

bool runFileWork(std::function<void()> work, const std::function<bool()>& called_off) {
  const auto outcome = std::make_shared<Outcome>();
  std::thread([work = std::move(work), outcome] { doWork(work, *outcome); }).detach();
  std::unique_lock<std::mutex> lock(outcome->mutex);
  double give_up = -1.0;
  while (!outcome->done) {
    outcome->changed.wait_for(lock, kLook);
    if (give_up < 0.0 && called_off()) give_up = steadyNow() + kLastWait;
    if (give_up >= 0.0 && steadyNow() > give_up) break;
  }
  if (outcome->error) std::rethrow_exception(outcome->error);
  return outcome->done;
}

}  // namespace haptic_cloth
