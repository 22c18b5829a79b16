/// Loops over threads, with results that do not depend on their number. Only this file uses OpenMP.
#pragma once

#include <time.h>

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "parallel/block_order.h"

namespace haptic_cloth {

/// Sums that are formed in one pass over a list.
using Sums = Eigen::Array<double, 6, 1>;

/// Decides whether a parallel region pays. Threads that share a core with other programs take turns, and a
/// thread that was taken off its core makes the others wait. And cores may exchange what the threads write so
/// slowly that loops take longer than on one; that depends on the machine, on the number of particles and,
/// where a host moves virtual cores, on the moment. So now and then two runs on one thread measure what loops
/// take there. After a region that did not pay, the next runs use one thread; their number doubles with each
/// such region in a row.
class Backoff {
 public:
  /// Measurements of a region.
  struct Region {
    double lost;  ///< time in which the caller waited or had no core [s]
    double all;   ///< time that the region took [s]
    double cost;  ///< time of its shared loops over the time estimated for one thread; 0: there was none
  };

  /// Tells whether the next run is to use one thread, and counts it.
  bool alone() { return left_ > 0 && left_-- > 0; }

  /// Records a run with one thread. @param cost of the loops that a region shares; 0: there was none
  void noteAlone(double cost) {
    if (cost > 0.0) cost_alone_ = cost_alone_ > 0.0 ? 0.5 * (cost_alone_ + cost) : cost;
    regions_ = 0;
  }

  /// Records a region.
  void note(const Region& region) {
    const bool crowded = region.lost > kMostLost * region.all;
    // The first region after a run alone finds the cloth in the caller's cache.
    const bool judged = ++regions_ > 1 && cost_alone_ > 0.0 && region.cost > 0.0;
    const bool slow = judged && region.cost > kMostCost * cost_alone_;
    left_ = crowded || slow ? length_ : regions_ < kRegions ? 0 : kMeasured;
    if (crowded || slow)
      length_ = std::min(2 * length_, kLongest);
    else if (judged)
      length_ = kShortest;
  }

 private:
  /// Largest lost share of a region; beyond it two threads gain little or lose.
  static constexpr double kMostLost = 0.25;
  /// Largest cost over that of one thread; what runs between the loops takes longer beside other threads.
  static constexpr double kMostCost = 0.9;
  static constexpr int kShortest = 8, kLongest = 512;  ///< number of runs with one thread
  static constexpr int kMeasured = 2, kRegions = 512;  ///< runs that measure one thread; regions between them
  static constexpr int kFirst = 3;                     ///< regions before the first of these runs
  double cost_alone_ = 0.0;
  int length_ = kShortest, left_ = 0, regions_ = kRegions - kFirst;
};

/// Runs loops over index ranges. Work is divided into blocks of fixed size for any number of
/// threads; sums are formed for each block and added in block order. So the number of threads never
/// changes the bits.
///
/// The threads meet once, in run(). It opens one parallel region, in which the caller continues and
/// the others wait for its loops; they spin, because the next loop is microseconds away. Each
/// thread first takes blocks of its own part of a loop and then helps the others. A thread that was
/// taken off its core delays only the block that it was working on.
class Team {
 public:
  static constexpr int kBlock = BlockOrder::kBlock;

  // Approximate times of one item on one core [s], to decide whether a loop is worth sharing.
  static constexpr double kElement = 5e-9, kNode = 8e-9, kEntry = 4e-10;

  /// Number of threads that OpenMP gives: one for each core, or OMP_NUM_THREADS.
  static int available() {
#ifdef _OPENMP
    return std::max(1, omp_get_max_threads());
#else
    return 1;
#endif
  }

  /// @param threads largest number of threads; 0: all that are available
  explicit Team(int threads) : threads_(threads > 0 ? threads : available()), loop_(new Loop(threads_)) {}

  int threads() const { return threads_; }

  /// Reserves memory for sums over up to `count` items.
  void reserve(int count) { partial_.reserve(BlockOrder::blocks(count)); }

  /// Calls body(), whose loops run on several threads.
  /// @param particles number of particles in the work; few use fewer threads
  template <class Body>
  void run([[maybe_unused]] int particles, const Body& body) {
#ifdef _OPENMP
    const int wanted = kShareAll ? threads_ : std::min(threads_, 1 + particles / kParticlesPerThread);
    if (wanted > 1 && !loop_->open && (kShareAll || !backoff_.alone())) {
      std::exception_ptr failure;  // no exception may leave the region
      const auto start = Clock::now();
      const double worked = coreSeconds();
      auto end = start;
      loop_->open = true;
      loop_->waited = 0.0;
      times_ = {};
      loop_->closed.store(false, std::memory_order_relaxed);
#pragma omp parallel num_threads(wanted)
      {
        if (omp_get_thread_num() == 0) {
          loop_->members.store(omp_get_num_threads(), std::memory_order_relaxed);
          try {
            body();
          } catch (...) {
            failure = std::current_exception();
          }
          loop_->closed.store(true, std::memory_order_release);
          end = Clock::now();
        } else {
          loop_->serve(omp_get_thread_num());
        }
      }
      loop_->open = false;
      const auto left = Clock::now();
      const double all = seconds(left - start), off_core = all - (coreSeconds() - worked);
      backoff_.note({off_core + loop_->waited + seconds(left - end), all, times_.cost()});
      if (failure) std::rethrow_exception(failure);
      return;
    }
    if (wanted > 1 && !loop_->open) {
      times_ = {};
      body();
      backoff_.noteAlone(times_.cost());
      return;
    }
#endif
    body();
  }

  /// Calls work(begin, end) for consecutive parts of [0, count).
  /// @param item time for one item [s]
  /// @param order in which threads take the blocks
  template <class Work>
  void forRange(int count, const Work& work, double item = kElement, const BlockOrder& order = {}) {
    const int blocks = BlockOrder::blocks(count);
    const auto alone = [&] {
      if (count > 0) work(0, count);
    };
    loop(blocks, count * item, alone, [&] {
      shareBlocks(blocks, [&](int position) {
        const int begin = order[position] * kBlock;
        work(begin, std::min(count, begin + kBlock));
      });
    });
  }

  /// Forms several sums at once: work(begin, end) returns those of its part of [0, count).
  /// @param item time for one item [s]
  /// @param order in which threads take the blocks; it does not change the bits
  template <class Work>
  Sums sum(int count, const Work& work, double item = kElement, const BlockOrder& order = {}) {
    const int blocks = BlockOrder::blocks(count);
    if (static_cast<int>(partial_.size()) < blocks) partial_.resize(blocks);
    const auto of_block = [&](int block) {
      partial_[block] = work(block * kBlock, std::min(count, (block + 1) * kBlock));
    };
    const auto alone = [&] {
      for (int block = 0; block < blocks; ++block) of_block(block);
    };
    loop(blocks, count * item, alone,
         [&] { shareBlocks(blocks, [&](int position) { of_block(order[position]); }); });
    Sums total = Sums::Zero();
    for (int block = 0; block < blocks; ++block) total += partial_[block];
    return total;
  }

  /// Calls body() here and task() on another thread, if one is there before body() has ended, else here after
  /// it. Neither may need the other; task() runs no loops of the team.
  template <class Task, class Body>
  void runBeside(const Task& task, const Body& body) {
    if (!loop_->open) {
      body();
      task();
      return;
    }
    std::exception_ptr failure;  // no exception may leave another thread
    const auto caught = [&] {
      try {
        task();
      } catch (...) {
        failure = std::current_exception();
      }
    };
    {
      // The task has to end before this call does, also if body() throws.
      struct Offer {
        Loop& loop;
        ~Offer() { loop.finishOffer(); }
      } offer{*loop_};
      loop_->offer([](const void* context, int) { (*static_cast<decltype(&caught)>(context))(); }, &caught);
      body();
    }
    if (failure) std::rethrow_exception(failure);
  }

  /// Calls work(k) for tasks 0 .. count-1, each long enough to be shared.
  template <class Work>
  void forTasks(int count, const Work& work) {
    if (loop_->open && isWorthSharing(count, 1.0)) return shareBlocks(count, work);
    for (int task = 0; task < count; ++task) work(task);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

  /// Time that this thread has spent on a core [s].
  static double coreSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  /// Shortest loop worth sharing: several times the time that threads need to meet [s].
  static constexpr double kWorthSharing = 4e-6;
  /// With fewer particles, threads mostly wait for each other.
  static constexpr int kParticlesPerThread = 300;
#ifdef HAPTIC_CLOTH_SHARE_ALL
  static constexpr bool kShareAll = true;  ///< for the thread sanitizer: it sees only shared loops
#else
  static constexpr bool kShareAll = false;
#endif

  /// @param seconds approximate time on one thread
  static bool isWorthSharing(int blocks, double seconds) {
    return blocks > 1 && (seconds >= kWorthSharing || kShareAll);
  }

  /// Times of the loops of a run that are worth sharing, whether they were shared or not [s].
  struct LoopTimes {
    double taken = 0.0, estimated = 0.0;  ///< estimated for one thread
    double cost() const { return estimated > 0.0 ? taken / estimated : 0.0; }
  };

  /// Adds the time until its end.
  class LoopTimer {
   public:
    LoopTimer(LoopTimes& times, double estimate) : times_(times) { times_.estimated += estimate; }
    ~LoopTimer() { times_.taken += seconds(Clock::now() - start_); }

   private:
    LoopTimes& times_;
    const Clock::time_point start_ = Clock::now();
  };

  /// Makes a loop: shared() in a region, if that pays, else alone(). @param estimate of alone() [s]
  template <class Alone, class Shared>
  void loop(int blocks, double estimate, const Alone& alone, const Shared& shared) {
    if (!isWorthSharing(blocks, estimate)) return alone();
    const LoopTimer timer(times_, estimate);
    loop_->open ? shared() : alone();
  }

  template <class Work>
  void shareBlocks(int blocks, const Work& work) {
    loop_->share(
        blocks, [](const void* context, int block) { (*static_cast<const Work*>(context))(block); }, &work);
  }

  /// Current loop. The part of each thread is one word, so that taking a unit is one atomic
  /// operation: the number of the loop, the next unit and the end. A unit is one or more blocks.
  class Loop {
   public:
    using Call = void (*)(const void* context, int block);

    explicit Loop(int threads) : parts_(new Part[threads]) {}

    std::atomic<int> members{1};      ///< number of threads in the region
    bool open = false;                ///< a region is open
    std::atomic<bool> closed{false};  ///< the region shall end
    /// Time that the caller waited for others beyond their last unit, or they had no core in its offer [s].
    double waited = 0.0;

    /// Runs blocks 0 .. blocks-1 on all threads. Returns when all are done.
    void share(int blocks, Call call, const void* context) {
      const int unit = 1 + blocks / kMostUnits, units = (blocks + unit - 1) / unit;
      call_.store(call, std::memory_order_relaxed);
      context_.store(context, std::memory_order_relaxed);
      unit_.store(unit, std::memory_order_relaxed);
      blocks_.store(blocks, std::memory_order_relaxed);
      unfinished_.store(units, std::memory_order_relaxed);
      ++number_;
      const long count = members.load(std::memory_order_relaxed);
      for (long t = 0; t < count; ++t) {
        const long first = units * t / count, end = units * (t + 1) / count;
        parts_[t].word.store(word(number_, first, end), std::memory_order_release);
      }
      announced_.store(number_, std::memory_order_release);
      help(0);
      int spin = 0;
      for (; spin < kPatience && unfinished_.load(std::memory_order_acquire) > 0; ++spin) pause(spin);
      if (spin < kPatience) return;
      const auto start = Clock::now();
      for (; unfinished_.load(std::memory_order_acquire) > 0; ++spin) pause(spin);
      waited += seconds(Clock::now() - start);
    }

    /// Offers a call to the other threads.
    void offer(Call call, const void* context) {
      offered_call_ = call;
      offered_context_ = context;
      offered_.store(Offered::Open, std::memory_order_release);
    }

    /// Makes the offered call if no thread has taken it, and returns when it is done.
    void finishOffer() {
      if (takeOffer()) return;
      for (int spin = 0; offered_.load(std::memory_order_acquire) != Offered::None; ++spin) pause(spin);
      waited += offered_off_core_;
    }

    /// Work of the other threads until the region is closed.
    void serve(int thread) {
      unsigned seen = announced_.load(std::memory_order_acquire) - 1;
      for (int spin = 0; !closed.load(std::memory_order_acquire); ++spin) {
        const unsigned now = announced_.load(std::memory_order_acquire);
        if (now == seen) {
          if (!takeOffer()) pause(spin);
          continue;
        }
        seen = now;
        help(thread);
        spin = 0;
      }
    }

   private:
    enum class Offered { None, Open, Taken };
    static constexpr int kMostUnits = 32768;
    static constexpr int kPatience = 2000;  ///< about 20 to 50 us

    struct alignas(64) Part {
      std::atomic<unsigned long long> word{0};
    };
    static unsigned long long word(unsigned number, long next, long end) {
      return static_cast<unsigned long long>(number) << 32 | static_cast<unsigned long long>(next) << 16 |
             static_cast<unsigned long long>(end);
    }

    /// Makes the offered call, unless another thread does. @return whether it did
    bool takeOffer() {
      Offered open = Offered::Open;
      if (offered_.load(std::memory_order_relaxed) != open) return false;
      if (!offered_.compare_exchange_strong(open, Offered::Taken, std::memory_order_acquire)) return false;
      const auto start = Clock::now();
      const double worked = coreSeconds();
      offered_call_(offered_context_, 0);
      offered_off_core_ = seconds(Clock::now() - start) - (coreSeconds() - worked);
      offered_.store(Offered::None, std::memory_order_release);
      return true;
    }

    /// Works on units until none is left, first on those of this thread.
    void help(int thread) {
      const int count = members.load(std::memory_order_relaxed);
      int finished = 0;
      for (int k = 0; k < count; ++k) {
        std::atomic<unsigned long long>& part = parts_[(thread + k) % count].word;
        unsigned long long seen = part.load(std::memory_order_acquire);
        while ((seen >> 16 & 0xffff) < (seen & 0xffff)) {
          // These belong to this loop if the word is unchanged when the unit is taken: then the
          // loop cannot have ended.
          const Call call = call_.load(std::memory_order_relaxed);
          const void* const context = context_.load(std::memory_order_relaxed);
          const int unit = unit_.load(std::memory_order_relaxed),
                    blocks = blocks_.load(std::memory_order_relaxed);
          const int first = static_cast<int>(seen >> 16 & 0xffff) * unit;
          if (!part.compare_exchange_weak(seen, seen + (1ull << 16), std::memory_order_acq_rel)) continue;
          for (int block = first; block < std::min(first + unit, blocks); ++block) call(context, block);
          ++finished;
          seen = part.load(std::memory_order_acquire);
        }
        if (finished > 0) unfinished_.fetch_sub(finished, std::memory_order_acq_rel);
        finished = 0;
      }
    }

    /// Waits a moment; after a long wait, yields the core.
    static void pause(int spin) {
      if (spin > kPatience) {
        std::this_thread::yield();
        return;
      }
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#endif
    }

    unsigned number_ = 0;
    std::unique_ptr<Part[]> parts_;  ///< one for each thread
    std::atomic<Call> call_{nullptr};
    std::atomic<const void*> context_{nullptr};
    std::atomic<int> unit_{1}, blocks_{0};
    alignas(64) std::atomic<int> unfinished_{0};      ///< number of units
    alignas(64) std::atomic<unsigned> announced_{0};  ///< number of the current loop
    alignas(64) std::atomic<Offered> offered_{Offered::None};
    Call offered_call_ = nullptr;
    const void* offered_context_ = nullptr;
    double offered_off_core_ = 0.0;  ///< time without a core of the thread that made the call [s]
  };

  int threads_;
  Backoff backoff_;
  LoopTimes times_;
  std::unique_ptr<Loop> loop_;
  std::vector<Sums> partial_;
};

}  // namespace haptic_cloth
