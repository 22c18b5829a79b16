#include "ros/solver_loop.h"

#include <algorithm>

#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kIdle = 1e-3;        ///< sleep while paused [s]
constexpr double kMaxBacklog = 0.02;  ///< wall time the solver may catch up after a slow step [s]
constexpr double kSmoothing = 0.1;    ///< weight of the newest step in the mean pace [-]
constexpr double kWindow = 1.0;       ///< of the statistics [s]

}  // namespace

SolverLoop::SolverLoop(const NodeOptions& options, SharedState& shared)
    : time_step_(options.scene.solver.time_step),
      probe_timeout_(options.probe_timeout),
      shared_(shared),
      simulation_(options.scene),
      wall_per_step_(time_step_) {}

void SolverLoop::run() {
  while (!shared_.stop) {
    resetWhenAsked();
    copyFrameWhenWanted();
    if (shared_.paused) {
      due_ = last_start_ = window_start_ = -1.0;
      sleepUntil(steadyNow() + kIdle);
      continue;
    }
    waitUntilDue();
    takeDevice();
    const StepReport report = simulation_.step();
    publishSnapshot();
    record(report);
  }
}

void SolverLoop::resetWhenAsked() {
  const std::uint64_t wanted = shared_.resets_wanted;
  if (wanted == resets_seen_) return;
  resets_seen_ = wanted;
  simulation_.reset();
  tracker_.reset();
  probe_present_ = false;
  window_start_ = -1.0;
  // "None yet": the haptic thread ramps down and starts softly on the new cloth.
  shared_.snapshot.write(ProbeSnapshot());
  shared_.frame_wanted = true;
  copyFrameWhenWanted();
  shared_.resets_done = wanted;
}

void SolverLoop::copyFrameWhenWanted() {
  if (!shared_.frame_wanted.exchange(false)) return;
  frame_.time = simulation_.time();
  simulation_.positions(frame_.positions);
  simulation_.cells(frame_.cells);
  simulation_.cellLoads(frame_.tension, frame_.bending);
  frame_.probe = simulation_.probe();
  frame_.valid = true;
  shared_.frame.write(frame_);
}

void SolverLoop::waitUntilDue() {
  double now = steadyNow();
  if (due_ < 0.0) due_ = now;
  due_ = std::max(due_, now - kMaxBacklog);
  if (due_ > now) {
    sleepUntil(due_);
    now = steadyNow();
  }
  due_ += time_step_;
  if (last_start_ >= 0.0) wall_per_step_ += kSmoothing * (now - last_start_ - wall_per_step_);
  wall_per_step_ = std::max(wall_per_step_, time_step_);
  last_start_ = now;
}

void SolverLoop::takeDevice() {
  const StampedSample& newest = shared_.device_for_solver.read();
  const DeviceSample& device = newest.sample;
  const bool fresh = device.received >= 0.0 && steadyNow() - device.received <= probe_timeout_;
  if (fresh) {
    // By the moves between steps: without a filter's lag the damper feels no more than what the proxy does
    // not follow, and in slow motion the hand is as fast as it is in simulated time.
    const Vec3 moved = probe_present_ ? Vec3(device.position - device_.position) : Vec3(Vec3::Zero());
    simulation_.setDevice(device.position, moved / time_step_);
  } else if (probe_present_) {
    simulation_.removeDevice();
  }
  probe_present_ = fresh;
  device_ = device;
}

void SolverLoop::publishSnapshot() {
  shared_.snapshot.write(tracker_.update(simulation_.probe(), device_, wall_per_step_, steadyNow()));
}

void SolverLoop::record(const StepReport& report) {
  const double now = steadyNow();
  window_.failed += report.failed;
  if (window_start_ < 0.0) {
    window_start_ = now;
    window_start_time_ = simulation_.time();
    window_.steps = 0;
    window_iterations_ = 0.0;
    return;
  }
  ++window_.steps;
  window_iterations_ += report.minimizer.iterations;
  if (now - window_start_ < kWindow) return;
  window_.taken = now;
  window_.wall = now - window_start_;
  window_.time = simulation_.time();
  window_.real_time_factor = (window_.time - window_start_time_) / window_.wall;
  window_.iterations = window_iterations_ / window_.steps;
  window_.kinetic = simulation_.energy().kinetic;
  window_.last = report;
  shared_.solver_stats.write(window_);
  window_start_ = now;
  window_start_time_ = window_.time;
  window_.steps = 0;
  window_iterations_ = 0.0;
}

}  // namespace haptic_cloth
