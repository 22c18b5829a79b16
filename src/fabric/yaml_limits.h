/// Limits of a YAML text, checked before anything is stored.
#pragma once

#include <cstddef>
#include <string>

namespace haptic_cloth {

/// Limits far above any scene or fabric; anything below them is read in about a second and 1 GB.
struct YamlLimits {
  static constexpr std::size_t kBytes = std::size_t{1} << 24;  ///< length of a text
  /// An alias counts as all values that it stands for.
  static constexpr std::size_t kValues = std::size_t{1} << 20;
  static constexpr int kDepth = 32;  ///< nesting of lists and mappings
};

/// Parses `text` without storing anything. Otherwise a few lines of anchors and aliases could stand
/// for more values than fit into memory, and a line of brackets could overflow the stack.
/// @param origin, has_lines for messages, as in YamlSource
/// @throws InputError beyond a limit, or if the value of an anchor contains itself
/// @throws YAML::Exception for malformed text
void checkYamlLimits(const std::string& text, const std::string& origin, bool has_lines);

}  // namespace haptic_cloth
