/// Vectors at nodes, one array a coordinate, as loops over lanes want them.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "haptic_cloth/types.h"
#include "parallel/lanes.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Arrays are padded to whole lanes; what lies past size() has no meaning but is finite.
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
  /// To `size` zeros.
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
    archive("x", coordinates_[0]);
    archive("y", coordinates_[1]);
    archive("z", coordinates_[2]);
  }

  /// Array of one coordinate: 0 x, 1 y, 2 z.
  std::vector<double>& coordinate(int c) { return coordinates_[c]; }
  const std::vector<double>& coordinate(int c) const { return coordinates_[c]; }

  /// The arrays for loops over lanes.
  struct ConstArrays {
    const double *x, *y, *z;
  };
  struct MutableArrays {
    double *x, *y, *z;
    operator ConstArrays() const { return {x, y, z}; }
  };
  MutableArrays arrays() { return {coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data()}; }
  ConstArrays arrays() const {
    return {coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data()};
  }

 private:
  int size_ = 0;
  std::array<std::vector<double>, 3> coordinates_;
};

using ConstArrays = Field::ConstArrays;
using MutableArrays = Field::MutableArrays;

/// Eight node numbers; `in_row` where they follow one another.
struct NodeLanes {
  int index[kLanes];
  bool in_row;

  void set(int lane, int node) { index[lane] = node; }
  void finish() {
    in_row = true;
    for (int l = 1; l < kLanes; ++l) in_row = in_row && index[l] == index[0] + l;
  }
};

static HAPTIC_CLOTH_INLINE Lanes gather(const double* values, const NodeLanes& nodes) {
  if (nodes.in_row) return load(values + nodes.index[0]);
  Lanes v;
  for (int l = 0; l < kLanes; ++l) v[l] = values[nodes.index[l]];
  return v;
}

static HAPTIC_CLOTH_INLINE Lanes3 gather(const ConstArrays& field, const NodeLanes& nodes) {
  return {gather(field.x, nodes), gather(field.y, nodes), gather(field.z, nodes)};
}

static HAPTIC_CLOTH_INLINE Lanes3 load(const ConstArrays& field, int first) {
  return {load(field.x + first), load(field.y + first), load(field.z + first)};
}
static HAPTIC_CLOTH_INLINE void store(const MutableArrays& field, int first, const Lanes3& v) {
  store(field.x + first, v.x);
  store(field.y + first, v.y);
  store(field.z + first, v.z);
}

}  // namespace haptic_cloth
