#include "ros/node/real_time.h"

#include <pthread.h>
#include <ros/poll_manager.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <boost/make_shared.hpp>
#include <cerrno>
#include <cstring>
#include <memory>

namespace haptic_cloth {
namespace {

/// Priorities above user threads and below the kernel's interrupt threads (90 and more).
constexpr int kHapticPriority = 80, kMessagePriority = 79;

/// Sets the priority of the calling thread. @return 0 or the error number
int requestPriority(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
}

/// Raises the priority of the thread that serves the queue.
class RaiseCaller : public ros::CallbackInterface {
 public:
  CallResult call() override {
    requestPriority(kMessagePriority);
    return Success;
  }
};

}  // namespace

std::string requestRealTime() {
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  const int refused = requestPriority(kHapticPriority);
  std::string got = refused ? std::string("SCHED_OTHER (SCHED_FIFO: ") + std::strerror(refused) + ")"
                            : "SCHED_FIFO " + std::to_string(kHapticPriority);
  // With a memlock limit, locking all future memory would make later allocations fail, which is
  // worse than a page fault.
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY) return got + ", memory not locked (memlock limit)";
  const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  return got +
         (locked ? ", memory locked" : std::string(", memory not locked (") + std::strerror(errno) + ")");
}

void prioritiseMessages(ros::CallbackQueue& poses) {
  poses.addCallback(boost::make_shared<RaiseCaller>());
  // The network thread calls the listener in each of its rounds.
  ros::PollManager::instance()->addPollThreadListener([raised = std::make_shared<bool>(false)] {
    if (!*raised) requestPriority(kMessagePriority);
    *raised = true;
  });
}

}  // namespace haptic_cloth
