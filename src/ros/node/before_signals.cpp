#include "ros/node/before_signals.h"

#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <thread>
#include <utility>

namespace haptic_cloth {
namespace {

using Rests = std::list<std::function<void()>>;

/// Relay of signals, one per process. It is never destroyed, because a signal may come at any time.
class Relay {
 public:
  static Relay& instance() {
    static Relay* const relay = new Relay;
    return *relay;
  }

  Rests::iterator add(std::function<void()> rest) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (rests_.empty()) takeSignals();
    return rests_.insert(rests_.end(), std::move(rest));
  }

  void remove(Rests::iterator rest) {
    const std::lock_guard<std::mutex> lock(mutex_);
    rests_.erase(rest);
    if (rests_.empty()) giveSignalsBack();
  }

 private:
  struct Taken {
    int signal;
    bool taken = false;
    struct sigaction before {};
  };

  Relay() {
    sem_init(&woken_, 0, 0);
    std::thread([this] { watch(); }).detach();
  }

  /// Signal handler. It only wakes the thread that does the work.
  static void handle(int signal) {
    const int error = errno;
    instance().came_ = signal;
    sem_post(&instance().woken_);
    errno = error;
  }

  void watch() {
    while (true) {
      if (sem_wait(&woken_) != 0) continue;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (const auto& rest : rests_) rest();
        giveSignalsBack();
      }
      kill(getpid(), came_);
    }
  }

  void takeSignals() {
    struct sigaction ours {};
    ours.sa_handler = handle;
    ours.sa_flags = SA_RESTART;
    for (Taken& entry : signals_) {
      if (entry.taken) continue;
      sigaction(entry.signal, nullptr, &entry.before);
      entry.taken = entry.before.sa_handler != SIG_IGN;
      if (entry.taken) sigaction(entry.signal, &ours, nullptr);
    }
  }

  void giveSignalsBack() {
    for (Taken& entry : signals_) {
      struct sigaction now {};
      sigaction(entry.signal, nullptr, &now);
      // A handler that was installed since then stays.
      if (entry.taken && now.sa_handler == handle) sigaction(entry.signal, &entry.before, nullptr);
      entry.taken = false;
    }
  }

  std::mutex mutex_;
  Rests rests_;
  std::array<Taken, 4> signals_{Taken{SIGINT}, Taken{SIGTERM}, Taken{SIGHUP}, Taken{SIGQUIT}};
  std::atomic<int> came_{0};
  sem_t woken_;
};

}  // namespace

BeforeSignals::BeforeSignals(std::function<void()> rest) : place_(Relay::instance().add(std::move(rest))) {}

BeforeSignals::~BeforeSignals() { Relay::instance().remove(place_); }

}  // namespace haptic_cloth
