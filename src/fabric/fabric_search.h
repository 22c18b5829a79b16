/// Search for fabric files.
#pragma once

#include <string>
#include <vector>

namespace haptic_cloth {

/// All files that findFabric() tries, in order.
std::vector<std::string> fabricCandidates(const std::string& name_or_path, const std::string& base_directory);

/// Names that findFabric() finds, in alphabetical order.
std::vector<std::string> fabricNames(const std::string& base_directory);

}  // namespace haptic_cloth
