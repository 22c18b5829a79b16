#include "ros/haptic_thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "haptics/tick_phase.h"
#include "ros/admittance_probe.h"
#include "ros/haptic_probe.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr int kPriority = 80;         ///< above user threads, below the kernel's interrupt threads (90+)
constexpr double kWindow = 1.0;       ///< of the statistics [s]
constexpr double kMaxBacklog = 0.02;  ///< ticks older than this are given up [s]
constexpr int kMaxRampTicks = 200;    ///< before the zeros at the end
constexpr int kZeros = 20;            ///< sent at the end: drivers hold the last force for ever
constexpr double kZeroPeriod = 2e-3;  ///< between them [s]

}  // namespace

std::string requestRealTime() {
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  sched_param parameter{};
  parameter.sched_priority = kPriority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  std::string got = refused ? std::string("SCHED_OTHER (SCHED_FIFO: ") + std::strerror(refused) + ")"
                            : "SCHED_FIFO " + std::to_string(kPriority);
  // With a limit, locking all future memory would make later allocations fail: worse than a page fault.
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY) return got + ", memory not locked (memlock limit)";
  const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  return got +
         (locked ? ", memory locked" : std::string(", memory not locked (") + std::strerror(errno) + ")");
}

HapticThread::HapticThread(const NodeOptions& options, const std::vector<ProbePublishers>& publishers,
                           SharedState& shared)
    : period_(1.0 / options.haptics.rate), shared_(shared) {
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
  double due = steadyNow() + period_;
  while (!shared_.stop) {
    sleepUntil(due);
    const double now = steadyNow();
    tick(now, shared_.paused);
    record(now, now - due);
    due = inPhase(due + period_, heard(), period_);
    if (now - due > kMaxBacklog) due = now + period_;
  }
  endAtRest();
}

double HapticThread::heard() const {
  double newest = -1.0;
  for (const auto& probe : probes_) newest = newest < 0.0 ? probe->heard() : newest;
  return newest;
}

void HapticThread::tick(double now, bool paused) {
  for (const auto& probe : probes_) probe->tick(now, paused);
}

bool HapticThread::isQuiet() const {
  return std::all_of(probes_.begin(), probes_.end(), [](const auto& probe) { return probe->isQuiet(); });
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

void HapticThread::endAtRest() {
  // As in a pause: down within the ramp time.
  for (int i = 0; i < kMaxRampTicks && !isQuiet(); ++i) {
    sleepUntil(steadyNow() + period_);
    tick(steadyNow(), true);
  }
  for (int i = 0; i < kZeros; ++i) {
    for (const auto& probe : probes_) probe->sendLast();
    sleepUntil(steadyNow() + kZeroPeriod);
  }
}

}  // namespace haptic_cloth
