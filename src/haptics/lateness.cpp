#include "haptics/lateness.h"

#include <algorithm>

namespace haptic_cloth {

void LatenessHistogram::add(double lateness) {
  const double bucket = std::clamp(lateness / kWidth, 0.0, kBuckets - 1.0);
  ++buckets_[static_cast<int>(bucket)];
  ++count_;
  max_ = std::max(max_, lateness);
}

double LatenessHistogram::quantile(double share) const {
  if (count_ == 0) return 0.0;
  const double wanted = share * count_;
  int seen = 0;
  for (int bucket = 0; bucket < kBuckets - 1; ++bucket) {
    seen += buckets_[bucket];
    if (seen >= wanted) return std::min(max_, (bucket + 1) * kWidth);
  }
  return max_;
}

}  // namespace haptic_cloth
