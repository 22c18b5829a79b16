/// Hysteresis memory of the elements of one kind.
#pragma once

#include <vector>

#include "energy/packs.h"
#include "state/archive.h"

namespace haptic_cloth {

/// One Loop::Step for each place in the packs; empty if no law of the kind has memory.
class ElementMemory {
 public:
  void reserve(int places) { packs_.reserve(places / kPack + 2); }
  void resize(int places) { packs_.resize(places / kPack); }

  /// Law of the element at a place; without memory its play is zero.
  Loop::Step get(int place) const {
    return packs_.empty() ? Loop::Step{} : packs_[place / kPack].get(place % kPack);
  }
  void set(int place, const Loop::Step& step) { packs_[place / kPack].set(place % kPack, step); }

  /// Commits the elements of a pack that left their path.
  /// @param areas areas of the elements, zero if there is no element
  void commit(int pack, const Loop& law, const double* deformations, const double* areas);

  /// Memory in the format of the kernels; null if there is none.
  const StepPack* packs() const { return packs_.empty() ? nullptr : packs_.data(); }

  void serialize(Archive& archive);

 private:
  std::vector<StepPack> packs_;
};

}  // namespace haptic_cloth
