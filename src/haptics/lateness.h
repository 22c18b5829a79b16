/// Lateness of the ticks of a periodic thread.
#pragma once

#include <array>

namespace haptic_cloth {

/// Counts of lateness in buckets of 5 µs up to 10 ms; later ones count in the last. No allocation.
class LatenessHistogram {
 public:
  void add(double lateness);  ///< [s]
  void clear() { *this = LatenessHistogram(); }
  int count() const { return count_; }
  double max() const { return max_; }  ///< [s]

  /// Smallest bucket bound [s] that at least `share` (0..1) of the ticks do not exceed; 0 without ticks.
  double quantile(double share) const;

 private:
  static constexpr int kBuckets = 2000;
  static constexpr double kWidth = 5e-6;
  std::array<int, kBuckets> buckets_{};
  int count_ = 0;
  double max_ = 0.0;
};

}  // namespace haptic_cloth
