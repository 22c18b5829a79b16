/// Table of options. One row holds all that is known of an option: reading, checking, comparing with
/// a state, live change and the reference pages go through these rows.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Names of the values of an enum, for reading and writing.
template <class Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

/// Name of a value. @pre the table contains it
template <class Enum>
std::string nameOf(const Names<Enum>& names, Enum value) {
  for (const auto& [name, own] : names) {
    if (own == value) return name;
  }
  return "";
}

/// Values that a number may take, ends included.
struct Range {
  double least = 0.0, most = 0.0;
  bool above = false;  ///< `least` itself is excluded
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Limits of numbers in scenes: products and quotients stay finite.
constexpr double kSmallest = 1e-12, kLargest = 1e12;
/// Largest position [m] and gravity [m/s²]; beyond it, millimetres are lost to rounding.
constexpr double kMostLength = 1e6;

constexpr Range kNoRange{};  ///< of options that are not numbers
constexpr Range kPositive{0.0, kLargest, true}, kNotNegative{0.0, kLargest};
constexpr Range kLength{0.0, kMostLength, true}, kDistance{0.0, kMostLength};
constexpr Range kPosition{-kMostLength, kMostLength};
constexpr Range atLeast(int least) { return {static_cast<double>(least), kInfinity}; }

/// One number, or a list of them.
template <class Number>
struct Numbers {
  Number* first;
  std::size_t count = 1;
};

/// An enum, whatever its type. The index counts in the order of the names.
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A key with a reader of its own, such as a list of pins.
struct OwnReader {
  std::string initial;  ///< default, for the reference
  std::string rule;     ///< for the reference
};

/// Place of the value of an option, by type.
using OptionField =
    std::variant<Numbers<double>, Numbers<int>, Quat*, bool*, std::string*, Choice, OwnReader>;

inline OptionField field(double& value) { return Numbers<double>{&value}; }
inline OptionField field(int& value) { return Numbers<int>{&value}; }
inline OptionField field(Vec3& value) { return Numbers<double>{value.data(), 3}; }
template <class Number, std::size_t N>
OptionField field(std::array<Number, N>& values) {
  return Numbers<Number>{values.data(), N};
}
inline OptionField field(Quat& value) { return &value; }
inline OptionField field(bool& value) { return &value; }
inline OptionField field(std::string& value) { return &value; }

template <class Enum>
OptionField field(Enum& value, const Names<Enum>& names) {
  Choice choice;
  for (const auto& entry : names) choice.names.push_back(entry.first);
  choice.get = [&value, names] {
    std::size_t index = 0;
    while (index < names.size() && names[index].second != value) ++index;
    return index;
  };
  choice.set = [&value, names](std::size_t index) { value = names[index].second; };
  return choice;
}

/// Ends of the slider of an option that may change while the node runs. The range may allow more.
struct Live {
  double low = 0.0, high = 0.0;  ///< not used for a choice
};

constexpr std::nullopt_t kFixed = std::nullopt;  ///< cannot change while the node runs
constexpr bool kInState = true;

/// One row. Its default is the value of a new struct.
struct Option {
  std::string key;
  OptionField field;
  Range range;
  std::string unit;     ///< empty: none
  std::string meaning;  ///< one sentence
  std::optional<Live> live = kFixed;
  bool in_state = false;  ///< a state loads only into a scene with the same value
};

/// Rows that point into one struct, which they must not outlive.
using Options = std::vector<Option>;

/// Rows below one key.
struct OptionGroup {
  std::string path;     ///< such as "haptics/"
  std::string meaning;  ///< empty, or one sentence
  Options options;
  /// Keys of earlier versions, and the rule by which they are refused.
  std::vector<std::pair<std::string, std::string>> removed = {};
};

std::vector<std::string> keysOf(const Options& options);

/// Rule of a choice: "must be one of a, b".
std::string oneOf(const std::vector<std::string>& names);

/// Maps a key to its place in the source, for messages ("cloth.size[0]" → "scene.yaml:3").
using Locate = std::function<std::string(const std::string& key)>;

/// Checks the range of every option, and the norm of quaternions.
/// @param prefix stands before the keys in messages
/// @throws InputError with locate(key) as file
void checkOptions(const Options& options, const std::string& prefix, const Locate& locate);

/// Sentence in plain text with choices and unit: "what is minimised: condensed, joint", "… [m]".
std::string describe(const Option& option);

/// Current value in YAML ("[0, 0, 1]").
std::string valueText(const Option& option);

/// Key with an index: "size[0]".
std::string indexed(const std::string& key, std::size_t index);

/// Markdown table of the options with their current values as defaults.
std::string markdownTable(const OptionGroup& group);

}  // namespace haptic_cloth
