#include "fabric/yaml_reader.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>

#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr std::size_t kLongestValue = 60;  ///< characters of a value shown in a message
constexpr char kQuoted[] = "!";            ///< tag that yaml-cpp gives to quoted text

bool isQuoted(const YAML::Node& node) { return node.Tag() == kQuoted; }

bool hasDigit(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::optional<int> parseInteger(const std::string& text) {
  if (!hasDigit(text) || text.find_first_not_of("0123456789+-") != std::string::npos) return {};
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  int value = 0;
  if (!(stream >> value) || !stream.eof()) return {};
  return value;
}

std::string oneLine(std::string text) {
  for (char& c : text) {
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  }
  if (text.size() > kLongestValue) text = text.substr(0, kLongestValue) + "...";
  return text;
}

std::string describeShort(const YAML::Node& node, int depth) {
  if (!node.IsDefined() || node.IsNull()) return "(nothing)";
  if (node.IsScalar()) return isQuoted(node) ? '"' + node.Scalar() + '"' : node.Scalar();
  if (depth == 0) return "...";
  const bool is_map = node.IsMap();
  std::string text;
  for (const auto& item : node) {
    if (!text.empty()) text += ", ";
    text += is_map ? describeShort(item.first, depth - 1) + ": " + describeShort(item.second, depth - 1)
                   : describeShort(item, depth - 1);
    if (text.size() > kLongestValue) break;
  }
  return is_map ? '{' + text + '}' : '[' + text + ']';
}

}  // namespace

std::string describe(const YAML::Node& node) { return oneLine(describeShort(node, 3)); }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string YamlSource::at(const std::string& key, int line) const {
  for (const std::string& prefix : overridden) {
    if (key.compare(0, prefix.size(), prefix) != 0) continue;
    if (key.size() == prefix.size() || key[prefix.size()] == '.' || key[prefix.size()] == '[')
      return overridden_by;
  }
  return has_lines && line >= 0 ? file + ':' + std::to_string(line + 1) : file;
}

YamlValue::YamlValue(YAML::Node node, std::shared_ptr<const YamlSource> source, std::string key)
    : node_(std::move(node)), source_(std::move(source)), key_(std::move(key)) {}

void YamlValue::fail(const std::string& rule) const {
  throw InputError(source_->at(key_, node_.Mark().line), key_, describe(node_), rule);
}

void YamlValue::failAt(const std::string& name, const YAML::Node& where, const std::string& rule) const {
  const std::string key = (key_.empty() ? "" : key_ + '.') + oneLine(name);
  throw InputError(source_->at(key, where.Mark().line), key, "", rule);
}

YamlValue YamlValue::child(const YAML::Node& node, const std::string& name) const {
  return YamlValue(node, source_, key_.empty() ? name : key_ + '.' + name);
}

double YamlValue::number() const {
  const auto value = node_.IsScalar() && !isQuoted(node_) ? readNumber(node_.Scalar()) : std::nullopt;
  if (!value) fail("must be a finite number");
  return *value;
}

int YamlValue::integer() const {
  const auto value = node_.IsScalar() && !isQuoted(node_) ? parseInteger(node_.Scalar()) : std::nullopt;
  if (value) return *value;
  const bool has_digits_only = node_.IsScalar() && !isQuoted(node_) && readNumber(node_.Scalar()) &&
                               node_.Scalar().find_first_of(".eE") == std::string::npos;
  constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
  fail(has_digits_only ? "must be within " + std::to_string(kLeast) + " to " + std::to_string(kMost)
                       : "must be an integer");
}

std::string YamlValue::text() const {
  if (!node_.IsScalar()) fail("must be text");
  if (node_.Scalar().empty()) fail("must not be empty");
  // A file's name would end there for the system, but not for us.
  if (node_.Scalar().find('\0') != std::string::npos) fail("must be text without a NUL character");
  return node_.Scalar();
}

std::vector<YamlValue> YamlValue::list() const {
  if (!node_.IsSequence()) fail("must be a list");
  std::vector<YamlValue> items;
  for (const auto& item : node_) {
    items.emplace_back(item, source_, key_ + '[' + std::to_string(items.size()) + ']');
  }
  return items;
}

std::vector<YamlValue> YamlValue::list(std::size_t count, const std::string& what) const {
  if (!node_.IsSequence() || node_.size() != count) {
    fail("must be a list of " + std::to_string(count) + ' ' + what);
  }
  return list();
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  if (!isMap()) fail("must be a mapping");
  std::vector<std::pair<std::string, YamlValue>> found;
  std::set<std::string> names;
  for (const auto& entry : node_) {
    const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : describe(entry.first);
    if (!names.insert(name).second) failAt(name, entry.first, "must not stand here twice");
    found.emplace_back(name, child(entry.second, name));
  }
  return found;
}

YamlMap::YamlMap(const YamlValue& value, std::vector<std::string> known)
    : value_(value), known_(std::move(known)) {
  if (!value_.isMap()) value_.fail("must be a mapping with keys out of: " + joined(known_));
  for (const auto& entry : value_.node()) {
    const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : describe(entry.first);
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
      const bool digits = name.find_first_not_of("0123456789") == std::string::npos;  // of {B: 0,04}
      const std::string hint = digits ? "; decimals follow a point" : "";
      value_.failAt(name, entry.first, "unknown key" + hint + "; known here: " + joined(known_));
    }
  }
  value_.entries();  // refuses a key that occurs twice
}

std::optional<YamlValue> YamlMap::find(const std::string& name) const {
  if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
    throw std::logic_error("YamlMap: " + name + " was not declared");
  }
  for (const auto& entry : value_.node()) {
    if (entry.first.Scalar() == name) return value_.child(entry.second, name);
  }
  return {};
}

YamlValue YamlMap::require(const std::string& name, const std::string& rule) const {
  const auto value = find(name);
  if (!value) value_.failAt(name, value_.node(), rule);
  return *value;
}

}  // namespace haptic_cloth
