#include "ros/haptic_thread.h"

#include <pthread.h>
#include <ros/time.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>

#include "ros/conversions.h"
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

HapticThread::HapticThread(const NodeOptions& options, const ros::Publisher& reaction, SharedState& shared)
    : frame_id_(options.frame_id),
      device_(options.device),
      period_(1.0 / options.haptics.rate),
      reaction_(reaction),
      shared_(shared),
      loop_(limitsAtProbe(options.haptics, options.device)) {}

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
    if (now - due > kMaxBacklog) due = now + period_;
  }
  endWithZeros();
}

void HapticThread::tick(double now, bool paused) {
  const StampedSample& device = shared_.device_for_haptics.read();
  force_ = loop_.tick(device.sample, shared_.snapshot.read(), paused, now);
  publish(force_, device);
  shared_.force.write(force_);
}

void HapticThread::publish(const Vec3& force, const StampedSample& device) {
  // With the pose's stamp the receiver can tell how old the force is; without a pose, the clock's.
  const bool answers = device.sample.received >= 0.0;
  reaction_.publish(toWrench(forceForDriver(device_, device.frame_rotation, force),
                             answers ? device.stamp : ros::Time::now(),
                             answers ? device.frame_id : frame_id_));
}

void HapticThread::record(double now, double lateness) {
  if (window_start_ < 0.0) window_start_ = now;
  window_.lateness.add(lateness);
  ++window_.ticks;
  if (now - window_start_ < kWindow) return;
  window_.taken = now;
  window_.wall = now - window_start_;
  window_.status = loop_.status();
  window_.force = force_;
  shared_.haptic_stats.write(window_);
  window_.lateness.clear();
  window_.ticks = 0;
  window_start_ = now;
}

void HapticThread::endWithZeros() {
  // As in a pause: down within the ramp time.
  for (int i = 0; i < kMaxRampTicks && !force_.isZero(0.0); ++i) {
    sleepUntil(steadyNow() + period_);
    tick(steadyNow(), true);
  }
  for (int i = 0; i < kZeros; ++i) {
    reaction_.publish(toWrench(Vec3::Zero(), ros::Time::now(), frame_id_));
    sleepUntil(steadyNow() + kZeroPeriod);
  }
}

}  // namespace haptic_cloth
