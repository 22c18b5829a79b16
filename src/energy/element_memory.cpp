#include "energy/element_memory.h"

namespace haptic_cloth {

void ElementMemory::commit(int pack, const Loop& law, const double* deformations, const double* areas) {
  // An element at rest stands at the end of its path and may leave it by a rounding error, which is
  // ignored.
  constexpr double kRounding = 1e-12;  // relative to the length of the path
  StepPack& steps = packs_[pack];
  for (int l = 0; l < kPack; ++l) {
    const double s = deformations[l], slack = kRounding * (steps.high[l] - steps.low[l]);
    const bool left = s > steps.high[l] + slack || s < steps.low[l] - slack;
    if (left && areas[l] > 0.0) steps.set(l, law.next(steps.get(l), s));
  }
}

void ElementMemory::serialize(Archive& archive) {
  constexpr std::size_t kDoubles = sizeof(StepPack) / sizeof(double);
  archive.doubles("memory", packs_.empty() ? nullptr : packs_.front().play, kDoubles * packs_.size());
}

}  // namespace haptic_cloth
