/// What the machine itself can do, with the instruction set that the library's own loops take.
#pragma once

#include <cstddef>
#include <vector>

namespace haptic_cloth {

/// Three arrays of doubles, `bytes` together; a ← b + s c moves all of them once (what it takes to fetch a's
/// lines before they are written is not counted, here as for the passes).
class Triad {
 public:
  explicit Triad(std::size_t bytes);

  void run();
  double bytes() const { return 3.0 * sizeof(double) * a_.size(); }
  double last() const { return a_.back(); }

 private:
  std::vector<double> a_, b_, c_;
};

/// Multiplications and additions of packs of eight that depend on nothing but their own chain, on `chains` of
/// them. @return something that depends on all of it
double multiplyAdd3(int rounds);
double multiplyAdd6(int rounds);
double multiplyAdd12(int rounds);

/// A square root and a division for each of `count` numbers, none waiting for another. @pre whole packs of
/// eight
double rootAndDivide(const double* values, int count);

/// Floating point operations of a round.
constexpr double multiplyAddFlops(int chains) { return 2.0 * 8.0 * chains; }

/// The instruction set that the dispatch has chosen.
const char* instructionSet();

}  // namespace haptic_cloth
