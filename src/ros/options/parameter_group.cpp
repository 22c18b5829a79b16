#include "ros/options/parameter_group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"

namespace haptic_cloth {

using XmlRpc::XmlRpcValue;

/// Reads a value into the member of its option.
struct ParameterGroup::Reader {
  const ParameterGroup& group;
  const std::string& key;

  void operator()(const Numbers<double>& numbers) const {
    const std::vector<double> values = group.numbers(key, numbers.count);
    std::copy(values.begin(), values.end(), numbers.first);
  }
  void operator()(const Numbers<int>& numbers) const {
    const std::vector<double> values = group.numbers(key, numbers.count);
    for (std::size_t k = 0; k < numbers.count; ++k) {
      const double value = values[k];
      if (!(std::abs(value) <= std::numeric_limits<int>::max()) || value != std::floor(value)) {
        group.fail(key, "must be a whole number");
      }
      numbers.first[k] = static_cast<int>(value);
    }
  }
  void operator()(Quat* value) const {
    const std::vector<double> entries = group.numbers(key, 4);
    const Quat quaternion(entries[3], entries[0], entries[1], entries[2]);
    if (!isRotation(quaternion)) group.fail(key, "must have norm 1");
    *value = quaternion.normalized();
  }
  void operator()(bool* value) const {
    XmlRpcValue entry = group.tree_[key];
    if (entry.getType() != XmlRpcValue::TypeBoolean) group.fail(key, "must be true or false");
    *value = static_cast<bool>(entry);
  }
  void operator()(std::string* value) const { *value = text(); }
  void operator()(const Choice& choice) const {
    const auto found = std::find(choice.names.begin(), choice.names.end(), text());
    if (found == choice.names.end()) group.fail(key, oneOf(choice.names));
    choice.set(static_cast<std::size_t>(found - choice.names.begin()));
  }
  void operator()(const OwnReader&) const {}

  std::string text() const {
    XmlRpcValue entry = group.tree_[key];
    if (entry.getType() != XmlRpcValue::TypeString) group.fail(key, "must be text");
    return static_cast<std::string>(entry);
  }
};

ParameterGroup::ParameterGroup(const XmlRpcValue& tree, const std::string& origin, const std::string& path)
    : tree_(tree), origin_(origin), path_(path) {
  if (tree_.getType() == XmlRpcValue::TypeInvalid || tree_.getType() == XmlRpcValue::TypeStruct) return;
  const std::string name = path_.substr(0, path_.find_last_of('/'));
  throw InputError(origin_, name, toYaml(tree_, origin_, name), "must be a mapping");
}

bool ParameterGroup::has(const std::string& key) const {
  return tree_.getType() == XmlRpcValue::TypeStruct && tree_.hasMember(key);
}

void ParameterGroup::read(const Options& options) {
  for (const Option& option : options) {
    known_.insert(option.key);
    if (has(option.key)) std::visit(Reader{*this, option.key}, option.field);
  }
  checkOptions(options, path_, [this](const std::string&) { return origin_; });
}

void ParameterGroup::read(const OptionGroup& group) {
  for (const auto& [key, advice] : group.removed) {
    if (has(key)) fail(key, advice);
  }
  read(group.options);
}

void ParameterGroup::read(const std::vector<OptionGroup>& groups) {
  read(groups.front());
  readBelow(groups.front().path, groups);
}

void ParameterGroup::readBelow(const std::string& path, const std::vector<OptionGroup>& groups) {
  for (const OptionGroup& below : groups) {
    if (below.path.size() <= path.size() || below.path.rfind(path, 0) != 0) continue;
    const std::string name = below.path.substr(path.size(), below.path.size() - path.size() - 1);
    if (name.find('/') != std::string::npos) continue;
    ParameterGroup parameters = group(name);
    parameters.read(below);
    parameters.readBelow(below.path, groups);
    parameters.rejectRest();
  }
}

std::vector<double> ParameterGroup::numbers(const std::string& key, std::size_t count) const {
  const XmlRpcValue entry = tree_[key];
  if (count == 1) {
    const std::optional<double> number = toNumber(entry);
    if (!number) fail(key, "must be a number");
    return {*number};
  }
  const std::string rule = "must be a list of " + std::to_string(count) + " finite numbers";
  if (entry.getType() != XmlRpcValue::TypeArray || entry.size() != static_cast<int>(count)) fail(key, rule);
  std::vector<double> values;
  for (int k = 0; k < entry.size(); ++k) {
    const std::optional<double> number = toNumber(entry[k]);
    if (!number || !std::isfinite(*number)) fail(key, rule);
    values.push_back(*number);
  }
  return values;
}

ParameterGroup ParameterGroup::group(const std::string& key) {
  known_.insert(key);
  return {has(key) ? tree_[key] : XmlRpcValue(), origin_, path_ + key + "/"};
}

XmlRpcValue ParameterGroup::rest() const {
  XmlRpcValue rest;
  rest.begin();  // makes `rest` an empty mapping
  if (tree_.getType() != XmlRpcValue::TypeStruct) return rest;
  for (const auto& member : tree_) {
    if (known_.count(member.first) == 0) rest[member.first] = member.second;
  }
  return rest;
}

void ParameterGroup::rejectRest() const { rejectRestBut({}); }

void ParameterGroup::rejectRestBut(const std::vector<std::string>& others) const {
  std::set<std::string> known = known_;
  known.insert(others.begin(), others.end());
  for (const auto& member : rest()) {
    if (known.count(member.first) > 0) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    throw InputError(origin_, path_ + member.first, "", "unknown parameter; known here: " + names);
  }
}

void ParameterGroup::fail(const std::string& key, const std::string& rule) const {
  throw InputError(origin_, path_ + key, toYaml(tree_[key], origin_, path_ + key), rule);
}

}  // namespace haptic_cloth
