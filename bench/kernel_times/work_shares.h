/// How evenly work falls to threads: counted, not measured, so no machine and no load changes it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cloth_case.h"

namespace haptic_cloth {

/// JSON of rows: for each case and 1 to 64 threads the most work of a thread over the mean, in percent
/// above 1. [M04] shares out its lists of active particles; without that each thread has a fixed part of the
/// finest grid.
std::string workSharesJson(const std::vector<std::unique_ptr<ClothCase>>& cases);

}  // namespace haptic_cloth
