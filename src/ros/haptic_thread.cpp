#include "ros/haptic_thread.h"

#include <algorithm>

#include "ros/real_time.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kWindow = 1.0;       ///< of the statistics [s]
constexpr double kMaxBacklog = 0.02;  ///< ticks older than this are given up [s]
constexpr int kMaxRampTicks = 200;    ///< before the zeros at the end
constexpr int kZeros = 20;            ///< sent at the end: drivers hold the last force for ever
constexpr double kZeroPeriod = 2e-3;  ///< between them [s]

}  // namespace

HapticThread::HapticThread(const NodeOptions& options, const std::vector<ros::Publisher>& reactions,
                           SharedState& shared)
    : period_(1.0 / options.haptics.rate), shared_(shared) {
  for (std::size_t k = 0; k < reactions.size(); ++k) {
    probes_.emplace_back(options.frame_id, options.probes[k], reactions[k], shared.probes[k]);
  }
}

void HapticThread::run() {
  scheduling_ = requestRealTime();
  scheduling_ready_ = true;
  double due = steadyNow() + period_;
  while (!shared_.stop) {
    sleepUntil(due);
    const double now = steadyNow();
    tick(now, shared_.paused);
    record(now, now - due);
    due += period_;
    if (now - due > kMaxBacklog) {
      window_.given_up += static_cast<std::uint64_t>((now - due) / period_);
      due = now + period_;
    }
  }
  endWithZeros();
}

void HapticThread::tick(double now, bool paused) {
  for (HapticProbe& probe : probes_) probe.tick(now, paused);
}

bool HapticThread::isQuiet() const {
  return std::all_of(probes_.begin(), probes_.end(),
                     [](const HapticProbe& probe) { return probe.isQuiet(); });
}

void HapticThread::record(double now, double lateness) {
  if (window_start_ < 0.0) window_start_ = now;
  window_.lateness.add(lateness);
  ++window_.ticks;
  if (now - window_start_ < kWindow) return;
  window_.taken = now;
  window_.wall = now - window_start_;
  shared_.haptic_stats.write(window_);
  window_.lateness.clear();
  window_.ticks = 0;
  window_start_ = now;
}

void HapticThread::endWithZeros() {
  // As in a pause: down within the ramp time.
  for (int i = 0; i < kMaxRampTicks && !isQuiet(); ++i) {
    sleepUntil(steadyNow() + period_);
    tick(steadyNow(), true);
  }
  for (int i = 0; i < kZeros; ++i) {
    for (HapticProbe& probe : probes_) probe.sendZero();
    sleepUntil(steadyNow() + kZeroPeriod);
  }
}

}  // namespace haptic_cloth
