/// Where fabrics are looked for.
#pragma once

#include <string>
#include <vector>

namespace haptic_cloth {

/// Every file that findFabric() tries, in its order.
std::vector<std::string> fabricCandidates(const std::string& name_or_path, const std::string& base_directory);

}  // namespace haptic_cloth
