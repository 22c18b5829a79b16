/// Balance of work between threads. It is counted, not measured, so it is independent of machine
/// and load.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cloth_case.h"

namespace haptic_cloth {

/// JSON rows: for each case and 1 to 64 threads the largest work of a thread over the mean, in
/// percent above 1. [M04] divides its lists of active particles; without that each thread has a
/// fixed part of the finest grid.
std::string workSharesJson(const std::vector<std::unique_ptr<ClothCase>>& cases);

}  // namespace haptic_cloth
