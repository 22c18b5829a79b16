/// Force law in the format of the kernels: polynomials on equal intervals.
#pragma once

#include <vector>

#include "haptic_cloth/loop.h"

namespace haptic_cloth {

/// ψ = p + s (q + ½ r s), f = q + r s.
struct alignas(32) LawInterval {  // one load of four doubles
  double p, q, r;
};

/// View of a LawTable.
struct LawView {
  /// One line, two lines that meet at zero (cloth that does not resist compression), a table, or a
  /// loop.
  enum class Kind { Line, TwoLines, Table, Loop } kind;
  double begin, inverse_step, last;  ///< last: index of the last interval of a curve
  const LawInterval* intervals;      ///< upper branch, then path and lower branch for a loop
};

/// Curves of a Loop: upper branch, path and lower branch, one after the other.
class LawTable {
 public:
  explicit LawTable(const Loop& law);

  /// View of the table. @pre the table outlives it
  LawView view() const { return {kind_, begin_, inverse_step_, last_, intervals_.data()}; }

 private:
  void append(const Curve& curve);
  bool joinLines(const Curve& curve);

  LawView::Kind kind_;
  double begin_ = 0.0, inverse_step_ = 1.0, last_ = 0.0;
  std::vector<LawInterval> intervals_;
};

}  // namespace haptic_cloth
