/// What a YAML text may hold at most, found out before any of it is kept.
#pragma once

#include <cstddef>
#include <string>

namespace haptic_cloth {

/// Far beyond any scene or fabric, and so little that whatever is below is read in about a second and 1 GB.
struct YamlLimits {
  static constexpr std::size_t kBytes = std::size_t{1} << 24;   ///< of a text
  static constexpr std::size_t kValues = std::size_t{1} << 20;  ///< an alias counts as all that it stands for
  static constexpr int kDepth = 32;                             ///< of lists and mappings in each other
};

/// Goes through `text` without keeping anything. Without it a few lines of anchors and aliases stand for more
/// values than any memory holds, and a line of brackets for a stack that overflows.
/// @param origin, has_lines for messages, as in YamlSource
/// @throws InputError beyond a limit, or where an anchor's value holds itself
/// @throws YAML::Exception for malformed text
void checkYamlLimits(const std::string& text, const std::string& origin, bool has_lines);

}  // namespace haptic_cloth
