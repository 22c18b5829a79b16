/// Strict reading of YAML: every value is typed, every key is known, and every message names file,
/// line, key, value and rule.
#pragma once

#include <yaml-cpp/yaml.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/error.h"

namespace haptic_cloth {

/// Source of a document, for messages.
struct YamlSource {
  std::string file;                     ///< path, or a name such as "~ (parameters)"
  bool has_lines = false;               ///< line numbers are useful in messages
  std::vector<std::string> overridden;  ///< keys whose values came from elsewhere
  std::string overridden_by;            ///< name of that: "--set"

  /// "scene.yaml:12", or overridden_by for a key that was overridden. @param line 0-based, < 0: unknown
  std::string at(const std::string& key, int line) const;
};

/// One value of a document, with its dotted key ("cloth.particles[0]").
class YamlValue {
 public:
  YamlValue(YAML::Node node, std::shared_ptr<const YamlSource> source, std::string key);

  double number() const;  ///< finite; booleans, quoted text, .nan and .inf are refused
  int integer() const;    ///< 3, not 3.0 or 0.1
  std::string text() const;
  std::vector<YamlValue> list() const;
  /// List of `count` entries. @param what name of the entries in the message ("numbers")
  std::vector<YamlValue> list(std::size_t count, const std::string& what) const;
  template <std::size_t N>
  std::array<double, N> numbers() const;
  template <std::size_t N>
  std::array<int, N> integers() const;
  /// Names and values of a mapping with free keys, in order.
  std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// Value for one of the given names.
  template <class T>
  T choice(const std::vector<std::pair<std::string, T>>& names) const;

  bool isMap() const { return node_.IsMap(); }
  bool isList() const { return node_.IsSequence(); }
  const YAML::Node& node() const { return node_; }
  const std::string& key() const { return key_; }

  /// Value of `name` below this one, which must be a mapping.
  YamlValue child(const YAML::Node& node, const std::string& name) const;
  [[noreturn]] void fail(const std::string& rule) const;
  /// Same as fail(), for a key below this one.
  [[noreturn]] void failAt(const std::string& name, const YAML::Node& where, const std::string& rule) const;

 private:
  YAML::Node node_;
  std::shared_ptr<const YamlSource> source_;
  std::string key_;
};

/// Mapping whose keys are all known.
class YamlMap {
 public:
  /// @param known every key that is allowed
  /// @throws InputError if `value` is not a mapping, or has another key or a key twice
  YamlMap(const YamlValue& value, std::vector<std::string> known);

  std::optional<YamlValue> find(const std::string& name) const;
  /// @param rule text of the message if the key is missing
  YamlValue require(const std::string& name, const std::string& rule = "is required") const;

  const YamlValue& value() const { return value_; }

 private:
  YamlValue value_;
  std::vector<std::string> known_;
};

/// YAML file or text with overrides.
class YamlDocument {
 public:
  static YamlDocument fromFile(const std::string& file);
  static YamlDocument fromText(const std::string& text, const std::string& origin);

  /// Sets a value: "a.b=VALUE" (VALUE in YAML; "a.0.b" and "a[0].b" reach into lists).
  /// @param by name of its source in messages, one for all assignments
  void override(const std::string& assignment, const std::string& by);

  YamlValue root() const;

  /// Place of the deepest part of `key` that the source contains ("scene.yaml:12").
  std::string locate(const std::string& key) const;

 private:
  YamlDocument(const std::string& text, const std::string& origin, bool has_lines);

  YAML::Node root_;
  YamlSource source_;
};

/// Parts of a dotted key: "a.b[0].c" and "a.b.0.c" → a, b, 0, c. Empty parts stay.
std::vector<std::string> splitKey(const std::string& key);

/// Words separated by commas: "a, b, c".
std::string joined(const std::vector<std::string>& words);

/// Value as written, on one line and shortened.
std::string describe(const YAML::Node& node);

template <std::size_t N>
std::array<double, N> YamlValue::numbers() const {
  const std::vector<YamlValue> items = list(N, "numbers");
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = items[i].number();
  return result;
}

template <std::size_t N>
std::array<int, N> YamlValue::integers() const {
  const std::vector<YamlValue> items = list(N, "integers");
  std::array<int, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = items[i].integer();
  return result;
}

template <class T>
T YamlValue::choice(const std::vector<std::pair<std::string, T>>& names) const {
  std::vector<std::string> known;
  for (const auto& [name, value] : names) {
    if (node_.IsScalar() && node_.Scalar() == name) return value;
    known.push_back(name);
  }
  fail("must be " + std::string(known.size() > 1 ? "one of " : "") + joined(known));
}

}  // namespace haptic_cloth
