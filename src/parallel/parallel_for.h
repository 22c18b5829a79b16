/// Loops shared out over threads, with results that do not depend on how many. The one place with OpenMP.
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

namespace haptic_cloth {

/// Sums formed in one pass over a list.
using Sums = Eigen::Array<double, 6, 1>;

/// Decides whether a region is worth opening while other programs use the cores. Threads that share a core
/// take turns, and one that the system has taken off its core makes the others wait. So a region in which the
/// caller lost much time is followed by runs without one: the more regions in a row lost time, the longer.
class Backoff {
 public:
  /// Whether the next run is to do without other threads. Counts it.
  bool alone() { return left_ > 0 && left_-- > 0; }

  /// @param lost seconds in which the caller waited or had no core  @param all seconds that the region took
  void note(double lost, double all) {
    const bool crowded = lost > kMostLost * all;
    length_ = crowded ? std::min(2 * length_, kLongest) : kShortest;
    left_ = crowded ? length_ : 0;
  }

 private:
  static constexpr double kMostLost = 0.25;            ///< of a region: two threads then gain little or lose
  static constexpr int kShortest = 4, kLongest = 512;  ///< runs
  int length_ = kShortest, left_ = 0;
};

/// Runs loops over index ranges. Work is cut into blocks of fixed size, whatever the number of
/// threads; sums are formed per block and added in block order. So the bits never change with the threads.
///
/// The threads meet once, in run(): one parallel region, in which the caller goes on alone and the others
/// wait for its loops, spinning, since the next one is microseconds away. Each thread has a part of a loop's
/// blocks and then helps the others with theirs: a thread that the system has taken off its core holds up no
/// more than the block it was at.
class Team {
 public:
  static constexpr int kBlock = 256;

  // About what an item takes one core [s]: for the decision whether a loop is worth sharing.
  static constexpr double kElement = 5e-9, kNode = 8e-9, kEntry = 4e-10;

  /// As many threads as OpenMP gives: one a core, or what OMP_NUM_THREADS says.
  static int available() {
#ifdef _OPENMP
    return std::max(1, omp_get_max_threads());
#else
    return 1;
#endif
  }

  /// @param threads at most; 0: all that are available
  explicit Team(int threads) : threads_(threads > 0 ? threads : available()), loop_(new Loop(threads_)) {}

  int threads() const { return threads_; }

  /// Makes room for sums over up to `count` items.
  void reserve(int count) { partial_.reserve((count + kBlock - 1) / kBlock); }

  /// Calls body(), whose loops are shared out. @param particles at work: few are not worth many threads
  template <class Body>
  void run([[maybe_unused]] int particles, const Body& body) {
#ifdef _OPENMP
    const int wanted = kShareAll ? threads_ : std::min(threads_, 1 + particles / kParticlesPerThread);
    if (wanted > 1 && !loop_->open && (kShareAll || !backoff_.alone())) {
      std::exception_ptr failure;  // none may leave the region
      const auto start = Clock::now();
      const double worked = coreSeconds();
      auto end = start;
      loop_->open = true;
      loop_->waited = 0.0;
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
      backoff_.note(off_core + loop_->waited + seconds(left - end), all);
      if (failure) std::rethrow_exception(failure);
      return;
    }
#endif
    body();
  }

  /// work(begin, end) for consecutive parts of [0, count). @param item time of one [s]
  template <class Work>
  void forRange(int count, const Work& work, double item = kElement) {
    const int blocks = (count + kBlock - 1) / kBlock;
    if (!isShared(blocks, count * item)) {
      if (count > 0) work(0, count);
      return;
    }
    shareBlocks(blocks, [&](int block) { work(block * kBlock, std::min(count, (block + 1) * kBlock)); });
  }

  /// Several sums at once: work(begin, end) returns those of its part of [0, count). @param item time of one
  /// [s]
  template <class Work>
  Sums sum(int count, const Work& work, double item = kElement) {
    const int blocks = (count + kBlock - 1) / kBlock;
    if (static_cast<int>(partial_.size()) < blocks) partial_.resize(blocks);
    const auto of_block = [&](int block) {
      partial_[block] = work(block * kBlock, std::min(count, (block + 1) * kBlock));
    };
    if (isShared(blocks, count * item)) {
      shareBlocks(blocks, of_block);
    } else {
      for (int block = 0; block < blocks; ++block) of_block(block);
    }
    Sums total = Sums::Zero();
    for (int block = 0; block < blocks; ++block) total += partial_[block];
    return total;
  }

  /// work(k) for tasks 0 .. count-1, each worth sharing.
  template <class Work>
  void forTasks(int count, const Work& work) {
    if (isShared(count, 1.0)) return shareBlocks(count, work);
    for (int task = 0; task < count; ++task) work(task);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

  /// Time for which this thread has had a core [s].
  static double coreSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  static constexpr double kWorthSharing = 4e-6;    ///< some times what it takes threads to meet [s]
  static constexpr int kParticlesPerThread = 300;  ///< with fewer, threads mostly wait for each other
#ifdef HAPTIC_CLOTH_SHARE_ALL
  static constexpr bool kShareAll = true;  ///< for the thread sanitizer: it sees only what is shared out
#else
  static constexpr bool kShareAll = false;
#endif

  /// @param seconds it takes one thread, about
  bool isShared(int blocks, double seconds) const {
    return loop_->open && blocks > 1 && (seconds >= kWorthSharing || kShareAll);
  }

  template <class Work>
  void shareBlocks(int blocks, const Work& work) {
    loop_->share(
        blocks, [](const void* context, int block) { (*static_cast<const Work*>(context))(block); }, &work);
  }

  /// The loop in hand. A thread's part of it is one word, so that taking a block is one atomic operation: the
  /// number of the loop, the next unit and the end, a unit being some blocks.
  class Loop {
   public:
    using Call = void (*)(const void* context, int block);

    explicit Loop(int threads) : parts_(new Part[threads]) {}

    std::atomic<int> members{1};      ///< threads in the region
    bool open = false;                ///< there is a region
    std::atomic<bool> closed{false};  ///< the region is to end
    double waited = 0.0;              ///< by the caller for others, longer than for their last unit [s]

    /// Shares out blocks 0 .. blocks-1, and returns when all are done.
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

    /// What the other threads do until the region is closed.
    void serve(int thread) {
      unsigned seen = announced_.load(std::memory_order_acquire) - 1;
      for (int spin = 0; !closed.load(std::memory_order_acquire); ++spin) {
        const unsigned now = announced_.load(std::memory_order_acquire);
        if (now == seen) {
          pause(spin);
          continue;
        }
        seen = now;
        help(thread);
        spin = 0;
      }
    }

   private:
    static constexpr int kMostUnits = 32768;
    static constexpr int kPatience = 2000;  ///< about 20 to 50 us

    struct alignas(64) Part {
      std::atomic<unsigned long long> word{0};
    };
    static unsigned long long word(unsigned number, long next, long end) {
      return static_cast<unsigned long long>(number) << 32 | static_cast<unsigned long long>(next) << 16 |
             static_cast<unsigned long long>(end);
    }

    /// Works on units until none is left, first on this thread's own.
    void help(int thread) {
      const int count = members.load(std::memory_order_relaxed);
      int finished = 0;
      for (int k = 0; k < count; ++k) {
        std::atomic<unsigned long long>& part = parts_[(thread + k) % count].word;
        unsigned long long seen = part.load(std::memory_order_acquire);
        while ((seen >> 16 & 0xffff) < (seen & 0xffff)) {
          // Of this loop, if the word is still the same when the unit is taken: then it cannot have ended.
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

    /// Waits a moment; where it takes longer, lets others have the core.
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
    std::unique_ptr<Part[]> parts_;  ///< a thread each
    std::atomic<Call> call_{nullptr};
    std::atomic<const void*> context_{nullptr};
    std::atomic<int> unit_{1}, blocks_{0};
    alignas(64) std::atomic<int> unfinished_{0};      ///< units
    alignas(64) std::atomic<unsigned> announced_{0};  ///< number of the loop in hand
  };

  int threads_;
  Backoff backoff_;
  std::unique_ptr<Loop> loop_;
  std::vector<Sums> partial_;
};

}  // namespace haptic_cloth
