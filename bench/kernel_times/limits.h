/// Limits of the machine, measured by plain loops without code from the library's kernels.
#pragma once

#include <cstddef>
#include <vector>

namespace haptic_cloth {

/// Three arrays of doubles with `bytes` together; a ← b + s c moves each of them once. Fetching the
/// lines of a before they are written is not counted, neither here nor for the passes.
class Triad {
 public:
  explicit Triad(std::size_t bytes);

  void run();
  double bytes() const { return 3.0 * sizeof(double) * a_.size(); }
  double last() const { return a_.back(); }

 private:
  std::vector<double> a_, b_, c_;
};

/// Multiplies and adds 24, 48 or 96 independent numbers. @return a value that depends on all of
/// them
double multiplyAdd24(int rounds);
double multiplyAdd48(int rounds);
double multiplyAdd96(int rounds);

/// A square root and a division for each of `count` numbers, all independent.
double rootAndDivide(const double* values, int count);

}  // namespace haptic_cloth
