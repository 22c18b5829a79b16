/// The one place with OpenMP pragmas: loops shared out over threads, with results that do not depend on how
/// many.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace haptic_cloth {

/// Sums formed in one pass over a list.
using Sums = Eigen::Array<double, 6, 1>;

/// Runs loops over index ranges on a fixed number of threads. Work is cut into blocks of fixed size, whatever
/// the number of threads; sums are formed per block and added in block order. So the bits never change.
class Team {
 public:
  static constexpr int kBlock = 256;

  /// @param threads 0: as many as OpenMP gives
  explicit Team(int threads) : threads_(threads > 0 ? threads : available()) {}

  int threads() const { return threads_; }

  /// work(begin, end) for consecutive parts of [0, count), in parallel.
  template <class Work>
  void forRange(int count, const Work& work) const {
    forBlocks((count + kBlock - 1) / kBlock,
              [&](int block) { work(block * kBlock, std::min(count, (block + 1) * kBlock)); });
  }

  /// Several sums at once: work(begin, end) returns those of its part of [0, count).
  template <class Work>
  Sums sum(int count, const Work& work) {
    const int blocks = (count + kBlock - 1) / kBlock;
    if (static_cast<int>(partial_.size()) < blocks) partial_.resize(blocks);
    forBlocks(blocks, [&](int block) {
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

  template <class Work>
  void forBlocks(int blocks, const Work& work) const {
#ifdef _OPENMP
    if (threads_ > 1 && blocks > 1) {
#pragma omp parallel for schedule(static) num_threads(threads_)
      for (int block = 0; block < blocks; ++block) work(block);
      return;
    }
#endif
    for (int block = 0; block < blocks; ++block) work(block);
  }

  int threads_;
  std::vector<Sums> partial_;
};

}  // namespace haptic_cloth
