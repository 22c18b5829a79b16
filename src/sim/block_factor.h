/// Direct solver for particles that springs couple.
#pragma once

#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/block.h"

namespace haptic_cloth {

/// Factor L D Lᵀ of a symmetric positive definite matrix of 3 × 3 blocks: the blocks of rows plus springs,
/// each between points Σ weights · x of a few rows. It is built row by row, up to the nonzero entries that
/// the elimination tree gives [Davis, Algorithm 849: LDL, ACM TOMS 31 (2005)]. Rows are taken in the order of
/// a nested dissection of their places [George, SIAM J. Numer. Anal. 10 (1973)], which keeps L sparse where
/// springs are short. Once its lists have grown it allocates nothing.
class BlockFactor {
 public:
  struct End {
    int row;
    double weight;
  };

  /// Gives room for some rows with a few springs each.
  void reserve(int rows);

  void clear();  ///< forgets all rows and springs

  /// Adds a row with its own block [N/m] and its place [m]. @return its index
  int addRow(const Block& own, const Vec3& place);

  /// Adds a spring with the energy ½ s · K s, s = Σ weights · x.
  /// @param stiffness K [N/m]  @param ends different rows
  void addSpring(const Block& stiffness, const std::vector<End>& ends);

  int rows() const { return static_cast<int>(own_.size()); }

  /// Factors the matrix. @return false if it is not positive definite
  bool factor();

  /// Replaces forces [N] by the motions that solve for them [m], both by row.  @pre factor() succeeded
  void solve(std::vector<Vec3>& values) const;

 private:
  struct Spring {
    Block stiffness;
    int ends, ends_end;
  };
  /// Spring of a row, with the row's weight.
  struct Pull {
    int spring;
    double weight;
  };
  /// Entry of L. Those of a row are consecutive, those of a column a linked list.
  struct Entry {
    int column, row, next;
    Mat3 value;
  };

  void dissect(int begin, int end);
  int separate(int begin, int end);
  bool addToFactor(int k);
  int listAncestors(int k);
  template <class Visit>
  void forNeighbours(int row, const Visit& visit) const;

  std::vector<Block> own_;
  std::vector<Vec3> places_;
  std::vector<Spring> springs_;
  std::vector<End> ends_;
  std::vector<int> pulls_of_;  ///< springs of each row, see listByNode()
  std::vector<Pull> pulls_;
  // In the order of elimination:
  std::vector<int> order_, rank_;  ///< row of each place in the order, and its inverse
  std::vector<int> parent_;        ///< in the elimination tree; -1: none
  std::vector<int> seen_;  ///< last row in which a column was met; while dissecting, the half of each row
  std::vector<int> path_;
  std::vector<Mat3> sums_;       ///< of the row in work
  std::vector<Mat3> inverse_;    ///< D⁻¹
  std::vector<int> entries_of_;  ///< first entry of each row
  std::vector<Entry> entries_;
  std::vector<int> first_, last_;  ///< entries of each column; -1: none
  mutable std::vector<Vec3> work_;
};

}  // namespace haptic_cloth
