/// Symmetric 3 × 3 matrices at nodes, used by the preconditioners.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Entries xx, yy, zz, yz, xz, xy.
using Block = Eigen::Matrix<double, 6, 1>;
using Blocks = std::vector<Block>;

/// a aᵀ
inline Block square(const Vec3& a) {
  Block block;
  block << a.x() * a.x(), a.y() * a.y(), a.z() * a.z(), a.y() * a.z(), a.x() * a.z(), a.x() * a.y();
  return block;
}

/// value times the identity matrix
inline Block isotropic(double value) {
  Block block;
  block << value, value, value, 0.0, 0.0, 0.0;
  return block;
}

inline Mat3 matrix(const Block& m) {
  return (Mat3() << m[0], m[5], m[4], m[5], m[1], m[3], m[4], m[3], m[2]).finished();
}

/// @pre symmetric
inline Block block(const Mat3& m) {
  Block entries;
  entries << m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1);
  return entries;
}

inline Vec3 product(const Block& m, const Vec3& v) {
  return {m[0] * v.x() + m[5] * v.y() + m[4] * v.z(), m[5] * v.x() + m[1] * v.y() + m[3] * v.z(),
          m[4] * v.x() + m[3] * v.y() + m[2] * v.z()};
}

/// [a] with [a] v = a × v
inline Mat3 crossMatrix(const Vec3& a) {
  return (Mat3() << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0).finished();
}

/// Stiffness against turns of a spring at the end of an arm [N·m]. @param spring its stiffness [N/m]
inline Mat3 aroundArm(const Block& spring, const Vec3& arm) {
  const Mat3 cross = crossMatrix(arm);
  return cross.transpose() * matrix(spring) * cross;
}

/// Inverse; zero if the matrix is not positive definite.
inline Block inverse(const Block& m) {
  Block cofactors;
  cofactors << m[1] * m[2] - m[3] * m[3], m[0] * m[2] - m[4] * m[4], m[0] * m[1] - m[5] * m[5],
      m[4] * m[5] - m[0] * m[3], m[3] * m[5] - m[1] * m[4], m[3] * m[4] - m[2] * m[5];
  const double determinant = m[0] * cofactors[0] + m[5] * cofactors[5] + m[4] * cofactors[4];
  const bool definite = m[0] > 0.0 && cofactors[2] > 0.0 && determinant > 0.0;
  return definite ? Block(cofactors / determinant) : Block(Block::Zero());
}

/// Blocks at nodes, one array for each entry.
class BlockField {
 public:
  void reserve(int capacity) {
    for (auto& list : entries_) list.reserve(padded(capacity));
  }
  void resize(int size) {
    for (auto& list : entries_) list.resize(padded(size));
  }
  /// Sets the size; all entries are zero.
  void clear(int size) {
    for (auto& list : entries_) list.assign(padded(size), 0.0);
  }
  Block operator[](int n) const {
    Block block;
    for (int k = 0; k < 6; ++k) block[k] = entries_[k][n];
    return block;
  }
  void set(int n, const Block& block) {
    for (int k = 0; k < 6; ++k) entries_[k][n] = block[k];
  }
  AlignedDoubles& entry(int k) { return entries_[k]; }
  BlockArrays arrays() {
    return {{entries_[0].data(), entries_[1].data(), entries_[2].data(), entries_[3].data(),
             entries_[4].data(), entries_[5].data()}};
  }

 private:
  std::array<AlignedDoubles, 6> entries_;
};

}  // namespace haptic_cloth
