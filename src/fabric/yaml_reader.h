/// Strict reading of YAML: every value is typed, every key known, every message names file, line, key, value
/// and rule.
#pragma once

#include <yaml-cpp/yaml.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Where a document came from, for messages.
struct YamlSource {
  std::string file;                     ///< path, or a name such as "~ (parameters)"
  bool has_lines = false;               ///< line numbers mean something to the reader of a message
  std::vector<std::string> overridden;  ///< keys whose values came from the command line

  /// "scene.yaml:12", or "--set" for a key that was overridden. @param line 0-based, < 0: unknown
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
  /// A list of `count` entries. @param what names them in the message ("numbers")
  std::vector<YamlValue> list(std::size_t count, const std::string& what) const;
  template <std::size_t N>
  std::array<double, N> numbers() const;
  template <std::size_t N>
  std::array<int, N> integers() const;
  Vec3 vector() const;
  /// Names and values of a mapping whose keys are free, in their order.
  std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// One of the given names.
  template <class T>
  T choice(const std::vector<std::pair<std::string, T>>& names) const;

  bool isMap() const { return node_.IsMap(); }
  bool isScalar() const { return node_.IsScalar(); }
  const YAML::Node& node() const { return node_; }
  const std::string& key() const { return key_; }

  /// The value of `name` below this one, which must be a mapping.
  YamlValue child(const YAML::Node& node, const std::string& name) const;
  [[noreturn]] void fail(const std::string& rule) const;
  /// As fail(), about a key below this one.
  [[noreturn]] void failAt(const std::string& name, const YAML::Node& where, const std::string& rule) const;

 private:
  YAML::Node node_;
  std::shared_ptr<const YamlSource> source_;
  std::string key_;
};

/// A mapping of which all keys are known beforehand.
class YamlMap {
 public:
  /// @param known every key that may stand here
  /// @throws InputError if `value` is no mapping, has another key, or one twice
  YamlMap(const YamlValue& value, std::vector<std::string> known);

  std::optional<YamlValue> find(const std::string& name) const;
  /// @param rule what the message says when the key is missing
  YamlValue require(const std::string& name, const std::string& rule = "is required") const;

  /// Overwrite `target` if the key is there; so defaults stay where the target was declared.
  void read(const std::string& name, double& target) const;
  void read(const std::string& name, int& target) const;
  void read(const std::string& name, Vec3& target) const;
  template <class T>
  void readChoice(const std::string& name, T& target,
                  const std::vector<std::pair<std::string, T>>& names) const;

  const YamlValue& value() const { return value_; }

 private:
  YamlValue value_;
  std::vector<std::string> known_;
};

/// A YAML file or text with overrides.
class YamlDocument {
 public:
  static YamlDocument fromFile(const std::string& file);
  static YamlDocument fromText(const std::string& text, const std::string& origin);

  /// Puts "a.b=VALUE" (VALUE in YAML; "a.0.b" and "a[0].b" reach into lists) into the tree.
  void override(const std::string& assignment);

  YamlValue root() const;

  /// Place in the source of the deepest part of `key` that is written there ("scene.yaml:12").
  std::string locate(const std::string& key) const;

 private:
  YamlDocument(const std::string& text, const std::string& origin, bool has_lines);

  YAML::Node root_;
  YamlSource source_;
};

/// The parts of a dotted key: "a.b[0].c" and "a.b.0.c" → a, b, 0, c. Empty parts stay.
std::vector<std::string> splitKey(const std::string& key);

/// "a, b, c".
std::string joined(const std::vector<std::string>& words);

/// A value as written, on one line and cut short where it is long.
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

template <class T>
void YamlMap::readChoice(const std::string& name, T& target,
                         const std::vector<std::pair<std::string, T>>& names) const {
  if (const auto value = find(name)) target = value->choice(names);
}

}  // namespace haptic_cloth
