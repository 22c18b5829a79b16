/// Friction of the last step, remembered for the next one.
#pragma once

#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/grid.h"
#include "state/archive.h"

namespace haptic_cloth {

/// Place in the flat cloth, counted in finest cells along warp and weft.
struct FlatPoint {
  double u = 0.0, v = 0.0;
};

/// Friction on the cloth by each solid at the end of the last step, as force per area. A sample that
/// was there finds its own value again; a new one finds that of the nearest sample which stood for
/// its place.
class FrictionMemory {
 public:
  explicit FrictionMemory(const Grid& grid) : grid_(grid), first_(grid.particles(), kNone) {}

  void reserve(int samples) { entries_.reserve(samples); }
  void clear();

  /// Remembers the friction of a sample [Pa].
  /// @param half half the width of the cloth that it stands for [finest cells]
  void add(int solid, const FlatPoint& at, double half, const Vec3& friction);

  /// Friction at a point; zero if nothing is remembered there [Pa].
  Vec3 find(int solid, const FlatPoint& at) const;

  void serialize(Archive& archive, int solids);

 private:
  struct Entry {
    int solid = 0;
    double u = 0.0, v = 0.0, half = 0.0;  ///< see add()
    Vec3 friction = Vec3::Zero();
    int next = 0;  ///< next entry in the same finest cell
  };
  static constexpr int kNone = -1;

  int& firstIn(double u, double v);
  void link(int entry);

  Grid grid_;
  std::vector<Entry> entries_;
  std::vector<int> first_;  ///< first entry in each finest cell; cells have the index of their corner
  double widest_ = 0.0;     ///< largest half width [finest cells]
};

}  // namespace haptic_cloth
