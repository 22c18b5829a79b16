/// Data layout for SIMD loops. It is the same on every machine; the kernels (lanes.h) decide how
/// many lanes of a pack they process at a time.
#pragma once

namespace haptic_cloth {

/// Number of elements in a pack.
constexpr int kPack = 8;

/// Smallest multiple of kPack that holds n.
constexpr int padded(int n) { return (n + kPack - 1) / kPack * kPack; }

/// Three arrays of coordinates, padded to whole packs.
struct ConstArrays {
  const double *x, *y, *z;
};
struct MutableArrays {
  double *x, *y, *z;
  operator ConstArrays() const { return {x, y, z}; }
};

/// Indices of one pack.
struct PackIndices {
  int index[kPack];
  unsigned rows;  ///< bit l is set if index[l + 1] == index[l] + 1

  void set(int lane, int value) { index[lane] = value; }

  /// Must follow the last set().
  void finish() {
    rows = 0;
    for (int l = 0; l + 1 < kPack; ++l) rows |= (index[l + 1] == index[l] + 1 ? 1u : 0u) << l;
  }
  bool anyOf(const char* flags) const {
    for (const int i : index) {
      if (flags[i]) return true;
    }
    return false;
  }
};

/// Nodes of a pack of cells: corners (i, j), (i+s, j), (i, j+s), (i+s, j+s).
struct PatchCorners {
  PackIndices at[4];
};

/// One array for each entry of symmetric 3 × 3 matrices: xx, yy, zz, yz, xz, xy.
struct BlockArrays {
  double* entry[6];
};

}  // namespace haptic_cloth
