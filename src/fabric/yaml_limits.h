/// Limits of a YAML text, checked before anything is stored.
#pragma once

#include <cstddef>
#include <string>

namespace haptic_cloth {

/// Limits far above any scene or fabric; anything below them is read in about a second and 1 GB.
struct YamlLimits {
  static constexpr std::size_t kBytes = std::size_t{1} << 24;   ///< length of a text
  static constexpr std::size_t kValues = std::size_t{1} << 20;  ///< numbers, texts, lists and mappings
  static constexpr int kDepth = 32;                             ///< nesting of lists and mappings
};

/// Parses `text` without storing anything, because a line of brackets could overflow the stack.
/// Aliases are refused: a few lines of them could stand for more values than fit into memory.
/// @param origin, has_lines for messages, as in YamlSource
/// @throws InputError beyond a limit, or for an alias
/// @throws YAML::Exception for malformed text
void checkYamlLimits(const std::string& text, const std::string& origin, bool has_lines);

}  // namespace haptic_cloth
