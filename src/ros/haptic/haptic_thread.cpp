#include "ros/haptic/haptic_thread.h"

#include <algorithm>

#include "haptics/tick_phase.h"
#include "ros/haptic/admittance_probe.h"
#include "ros/haptic/haptic_probe.h"
#include "ros/node/real_time.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kWindow = 1.0;       ///< of the statistics [s]
constexpr double kMaxBacklog = 0.02;  ///< ticks older than this are given up [s]
constexpr double kMaxRamp = 3.0;      ///< before the zeros at the end [s]; node_main ends all after 5 s
constexpr int kZeros = 20;            ///< sent at the end: drivers hold the last force for ever
constexpr double kZeroPeriod = 2e-3;  ///< between them [s]

}  // namespace

HapticThread::HapticThread(const NodeOptions& options, const std::vector<ProbePublishers>& publishers,
                           SharedState& shared)
    : period_(1.0 / options.haptics.rate), shared_(shared), live_(shared.live_for_haptics) {
  for (std::size_t k = 0; k < publishers.size(); ++k) {
    const ProbePublishers& to = publishers[k];
    if (options.probes[k].device.kind == DeviceKind::Admittance) {
      probes_.push_back(
          std::make_unique<AdmittanceProbe>(options, k, to.command, to.reaction, shared.probes[k]));
    } else {
      probes_.push_back(
          std::make_unique<HapticProbe>(options.frame_id, options.probes[k], to.reaction, shared.probes[k]));
    }
  }
}

void HapticThread::run() {
  scheduling_ = requestRealTime();
  scheduling_ready_ = true;
  // Zero comes first, whatever the other threads know by then.
  tick(steadyNow(), true);
  double due = steadyNow() + period_;
  while (!shared_.stop) {
    sleepUntil(due);
    takeOptions();
    const double now = steadyNow();
    tick(now, shared_.paused);
    const double sent = steadyNow();
    record(sent, sent - due);
    due = inPhase(due + period_, heard(now), period_);
    if (now - due > kMaxBacklog) {
      window_.given_up += static_cast<std::uint64_t>((now - due) / period_);
      due = now + period_;
    }
  }
  endAtRest();
}

/// Time of the newest message of the first device that is not silent [s]; < 0: all are.
double HapticThread::heard(double now) const {
  for (const auto& probe : probes_) {
    if (now - probe->heard() < kSilentDevice) return probe->heard();
  }
  return -1.0;
}

/// Between two ticks, for all probes at once. Nothing here waits or allocates.
void HapticThread::takeOptions() {
  if (!live_.readNew()) return;
  const LiveOptions& live = live_.newest();
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    probes_[k]->setOptions(live.options->probes[k], live.gains[k]);
  }
  const double period = 1.0 / live.options->haptics.rate;
  if (period == period_) return;
  period_ = period;
  window_start_ = -1.0;  // the statistics are of one rate
}

void HapticThread::tick(double now, bool paused) {
  for (const auto& probe : probes_) probe->tick(now, paused);
}

bool HapticThread::isQuiet() const {
  return std::all_of(probes_.begin(), probes_.end(), [](const auto& probe) { return probe->isQuiet(); });
}

void HapticThread::record(double now, double lateness) {
  if (window_start_ < 0.0) {
    window_start_ = now;
    window_.lateness.clear();
    window_.ticks = 0;
  }
  window_.lateness.add(lateness);
  ++window_.ticks;
  if (now - window_start_ < kWindow) return;
  window_.taken = now;
  window_.wall = now - window_start_;
  window_.rate = 1.0 / period_;
  shared_.haptic_stats.write(window_);
  window_.lateness.clear();
  window_.ticks = 0;
  window_start_ = now;
}

void HapticThread::endAtRest() {
  // The force goes down within the ramp time, as in a pause.
  const double give_up = steadyNow() + kMaxRamp;
  while (!isQuiet() && steadyNow() < give_up) {
    sleepUntil(steadyNow() + period_);
    tick(steadyNow(), true);
  }
  for (int i = 0; i < kZeros; ++i) {
    for (const auto& probe : probes_) probe->sendLast();
    sleepUntil(steadyNow() + kZeroPeriod);
  }
}

}  // namespace haptic_cloth
