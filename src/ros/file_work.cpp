#include "ros/file_work.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kLastWait = 1.0;               ///< after `stop`, for a file that is nearly written [s]
constexpr std::chrono::milliseconds kLook(10);  ///< between two looks at `stop`

/// Belongs to both threads, as either may be the last.
struct Outcome {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::string result;
  std::exception_ptr error;
};

void doWork(const std::function<std::string()>& work, Outcome& outcome) {
  std::string result;
  std::exception_ptr error;
  try {
    result = work();
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard<std::mutex> lock(outcome.mutex);
  outcome.result = std::move(result);
  outcome.error = error;
  outcome.done = true;
  outcome.changed.notify_one();
}

}  // namespace

std::string runFileWork(std::function<std::string()> work, const std::atomic<bool>& stop) {
  const auto outcome = std::make_shared<Outcome>();
  std::thread([work = std::move(work), outcome] { doWork(work, *outcome); }).detach();
  std::unique_lock<std::mutex> lock(outcome->mutex);
  double give_up = -1.0;
  while (!outcome->done) {
    outcome->changed.wait_for(lock, kLook);
    if (!stop) continue;
    if (give_up < 0.0) give_up = steadyNow() + kLastWait;
    if (steadyNow() > give_up) break;
  }
  if (!outcome->done) throw std::runtime_error("the node ends, and the file system has not answered");
  if (outcome->error) std::rethrow_exception(outcome->error);
  return std::move(outcome->result);
}

}  // namespace haptic_cloth
