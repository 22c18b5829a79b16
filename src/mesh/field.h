/// Vectors at nodes, one array for each coordinate, as the kernels need them.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "haptic_cloth/types.h"
#include "simd/aligned.h"
#include "simd/pack.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Vector in one lane of a pack.
inline Vec3 laneOf(const double (&values)[3][kPack], int lane) {
  return {values[0][lane], values[1][lane], values[2][lane]};
}

/// Arrays are padded to whole packs; entries from size() on have no meaning but are finite.
class Field {
 public:
  Field() = default;
  explicit Field(const std::vector<Vec3>& values) {
    resize(static_cast<int>(values.size()));
    for (int n = 0; n < size_; ++n) set(n, values[n]);
  }

  int size() const { return size_; }
  void reserve(int capacity) {
    for (auto& c : coordinates_) c.reserve(padded(capacity));
  }
  void resize(int size) {
    size_ = size;
    for (auto& c : coordinates_) c.resize(padded(size), 0.0);
  }
  /// Sets the size; all entries are zero.
  void clear(int size) {
    size_ = size;
    for (auto& c : coordinates_) c.assign(padded(size), 0.0);
  }
  void fill(double value) {
    for (auto& c : coordinates_) std::fill(c.begin(), c.end(), value);
  }

  Vec3 operator[](int n) const { return {coordinates_[0][n], coordinates_[1][n], coordinates_[2][n]}; }
  void set(int n, const Vec3& value) {
    for (int c = 0; c < 3; ++c) coordinates_[c][n] = value[c];
  }
  void add(int n, const Vec3& value) {
    for (int c = 0; c < 3; ++c) coordinates_[c][n] += value[c];
  }

  void serialize(Archive& archive) {
    const char* const names[] = {"x", "y", "z"};
    for (int c = 0; c < 3; ++c) archive.doubles(names[c], coordinates_[c].data(), coordinates_[c].size());
  }

  /// Array of one coordinate: 0 x, 1 y, 2 z.
  AlignedDoubles& coordinate(int c) { return coordinates_[c]; }
  const AlignedDoubles& coordinate(int c) const { return coordinates_[c]; }

  /// Arrays for the kernels.
  MutableArrays arrays() { return {coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data()}; }
  ConstArrays arrays() const {
    return {coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data()};
  }

 private:
  int size_ = 0;
  std::array<AlignedDoubles, 3> coordinates_;
};

}  // namespace haptic_cloth
