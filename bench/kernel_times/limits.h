/// What the machine itself can do, by plain loops that share nothing with the library's kernels.
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

/// Multiplications and additions of 24, 48 or 96 numbers, each on its own. @return something that depends on
/// all of it
double multiplyAdd24(int rounds);
double multiplyAdd48(int rounds);
double multiplyAdd96(int rounds);

/// A square root and a division for each of `count` numbers, none waiting for another.
double rootAndDivide(const double* values, int count);

}  // namespace haptic_cloth
