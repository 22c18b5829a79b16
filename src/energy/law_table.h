/// A force law as the kernels take it: polynomials on equal intervals.
#pragma once

#include <vector>

#include "haptic_cloth/loop.h"

namespace haptic_cloth {

/// ψ = p + s (q + ½ r s), f = q + r s.
struct alignas(32) LawInterval {  // one load of four doubles
  double p, q, r;
};

/// A LawTable without its owner.
struct LawView {
  /// A line, two lines that meet at zero (as cloth that does not resist compression), many, or a loop.
  enum class Kind { Line, TwoLines, Table, Loop } kind;
  double begin, inverse_step, last;  ///< last: of a curve's intervals
  const LawInterval* intervals;      ///< of the upper branch, the path and the lower branch
};

/// Loop's curves, those of the upper branch, the path and the lower branch one after the other.
class LawTable {
 public:
  explicit LawTable(const Loop& law);

  /// @pre the table outlives it
  LawView view() const { return {kind_, begin_, inverse_step_, last_, intervals_.data()}; }

 private:
  void append(const Curve& curve);
  bool joinLines(const Curve& curve);

  LawView::Kind kind_;
  double begin_ = 0.0, inverse_step_ = 1.0, last_ = 0.0;
  std::vector<LawInterval> intervals_;
};

}  // namespace haptic_cloth
