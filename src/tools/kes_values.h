/// The characteristic values a KES-F instrument reads off its curve.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/specimen.h"

namespace haptic_cloth {

/// Names and values in KES units, in the order of a KES chart: tension EMT [%], LT, WT [gf·cm/cm²], RT [%];
/// shear G [gf/(cm·deg)] (mean slope from 0.5° to 2.5°), 2HG at 0.5° and 2HG5 at 5° [gf/cm]; bending B
/// [gf·cm²/cm] (mean slope from 0.5 to 1.5/cm) and 2HB at 1/cm [gf·cm/cm]. Slopes and widths are means of
/// both sides.
std::vector<std::pair<std::string, double>> kesValues(const std::vector<KesRow>& rows, KesTest test);

}  // namespace haptic_cloth
