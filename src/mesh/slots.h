/// What elements leave for the nodes: a vector a slot, as x, y, z and a zero, so that one is one load wherever
/// it lies.
#pragma once

#include "haptic_cloth/types.h"
#include "simd/aligned.h"

namespace haptic_cloth {

class Slots {
 public:
  void reserve(int capacity) { values_.reserve(4 * static_cast<std::size_t>(capacity)); }
  /// To `size` zeros.
  void clear(int size) { values_.assign(4 * static_cast<std::size_t>(size), 0.0); }

  Vec3 operator[](int k) const { return {values_[4 * k], values_[4 * k + 1], values_[4 * k + 2]}; }
  void set(int k, const Vec3& value) {
    for (int c = 0; c < 3; ++c) values_[4 * k + c] = value[c];
  }

  double* data() { return values_.data(); }
  const double* data() const { return values_.data(); }

 private:
  AlignedDoubles values_;
};

}  // namespace haptic_cloth
