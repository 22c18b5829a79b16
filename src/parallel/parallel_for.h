/// The one place with OpenMP pragmas: loops shared out over threads, with results that do not depend on how
/// many.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace haptic_cloth {

/// Sums formed in one pass over a list.
using Sums = Eigen::Array<double, 6, 1>;

/// Runs loops over index ranges on a fixed number of threads. Work is cut into blocks of fixed size, whatever
/// the number of threads; sums are formed per block and added in block order. So the bits never change, and
/// it may be left to the clock whether a loop is shared out: a busy machine, or threads that sleep while they
/// wait, can make that cost more than it saves.
class Team {
 public:
  static constexpr int kBlock = 256;

  // About what an item takes one core [s]: for that decision alone.
  static constexpr double kElement = 5e-9, kNode = 8e-9, kEntry = 4e-10;

  /// @param threads 0: as many as OpenMP gives
  explicit Team(int threads) : threads_(threads > 0 ? threads : available()) {}

  int threads() const { return threads_; }

  /// Makes room for sums over up to `count` items.
  void reserve(int count) { partial_.reserve((count + kBlock - 1) / kBlock); }

  /// work(begin, end) for consecutive parts of [0, count), in parallel. @param item time of one [s]
  template <class Work>
  void forRange(int count, const Work& work, double item = kElement) {
    forBlocks((count + kBlock - 1) / kBlock, count * item,
              [&](int block) { work(block * kBlock, std::min(count, (block + 1) * kBlock)); });
  }

  /// Several sums at once: work(begin, end) returns those of its part of [0, count). @param item time of one
  /// [s]
  template <class Work>
  Sums sum(int count, const Work& work, double item = kElement) {
    const int blocks = (count + kBlock - 1) / kBlock;
    if (static_cast<int>(partial_.size()) < blocks) partial_.resize(blocks);
    forBlocks(blocks, count * item, [&](int block) {
      partial_[block] = work(block * kBlock, std::min(count, (block + 1) * kBlock));
    });
    Sums total = Sums::Zero();
    for (int block = 0; block < blocks; ++block) total += partial_[block];
    return total;
  }

 private:
  static int available() {
#ifdef _OPENMP
    return std::max(1, omp_get_max_threads());
#else
    return 1;
#endif
  }

  /// @param seconds it takes one thread, about
  template <class Work>
  void forBlocks(int blocks, double seconds, const Work& work) {
#ifdef HAPTIC_CLOTH_SHARE_ALL  // for the thread sanitizer: it sees only what is shared out
    if (threads_ > 1) return share(blocks, work);
#endif
    if (std::min(threads_, blocks) < 2 || seconds < kLeast) {
      for (int block = 0; block < blocks; ++block) work(block);
      return;
    }
    const unsigned place = loops_++ % kPeriod;
    if (place == 0) measured_ = expected_ = {0.0, 0.0};
    const bool tries = place < 2 * kTrials;
    const bool shared = tries ? place >= kTrials : measured_[1] * expected_[0] < measured_[0] * expected_[1];
    const auto start = Clock::now();
    if (shared) {
      share(blocks, work);
    } else {
      for (int block = 0; block < blocks; ++block) work(block);
    }
    if (!tries || place % kTrials < kWarmUp) return;  // the first have their data in another core's cache
    measured_[shared] += std::chrono::duration<double>(Clock::now() - start).count();
    expected_[shared] += seconds;
  }

  template <class Work>
  void share(int blocks, const Work& work) const {
#ifdef _OPENMP
// In turns: kinds of elements lie one after another, and in one piece the thread with the dearest would be
// late.
#pragma omp parallel for schedule(static, 1) num_threads(threads_)
#endif
    for (int block = 0; block < blocks; ++block) work(block);
  }

  using Clock = std::chrono::steady_clock;
  static constexpr double kLeast = 5e-6;  ///< shorter loops are never shared out [s]
  static constexpr unsigned kTrials = 40, kWarmUp = 20, kPeriod = 4000;

  int threads_;
  // In each period the first loops are run on one thread, as many then on all; the quicker way takes the
  // rest.
  unsigned loops_ = 0;
  std::array<double, 2> measured_{}, expected_{};  ///< time of a period's trials: on one thread, on all [s]
  std::vector<Sums> partial_;
};

}  // namespace haptic_cloth
