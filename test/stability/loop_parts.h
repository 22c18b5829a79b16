/// Parts of the closed loops between device, tick and solver.
#pragma once

#include <cmath>
#include <deque>

#include "haptics/probe_tracker.h"
#include "stability/closed_loop.h"

namespace haptic_cloth {

constexpr double kStep = 5e-5;  ///< time step of the device's motion [s]

/// Signal with a delay.
class DelayLine {
 public:
  explicit DelayLine(double delay) : steps_(static_cast<std::size_t>(std::lround(delay / kStep))) {}
  Vec3 pass(const Vec3& value) {
    queue_.push_back(value);
    if (queue_.size() <= steps_) return queue_.front();
    const Vec3 out = queue_.front();
    queue_.pop_front();
    return out;
  }

 private:
  std::size_t steps_;
  std::deque<Vec3> queue_;
};

/// Solver thread: takes the newest pose; its snapshot appears when the step ends.
class SolverThread {
 public:
  SolverThread(const SolverModel& model, ProbeWorld& world) : model_(model), world_(world) {}

  void run(double now, const DeviceSample& device, ProbeSnapshot& published) {
    const double pace = model_.time_step * model_.slowness;
    if (now < ready_) return;
    if (started_) published = next_;
    if (started_) published.taken = now;
    const ProbeReport report = world_.solve(device.position, (device.position - last_) / model_.time_step);
    next_ = tracker_.update(report, device, pace, now);
    last_ = device.position;
    started_ = true;
    ready_ = now + pace - 1e-9;
    if (ready_ > model_.stall_from && now < model_.stall_from + model_.stall_time)
      ready_ += model_.stall_time;
  }

 private:
  SolverModel model_;
  ProbeWorld& world_;
  ProbeTracker tracker_;
  ProbeSnapshot next_;
  Vec3 last_ = Vec3::Zero();
  bool started_ = false;
  double ready_ = 0.0;
};

}  // namespace haptic_cloth
