#include "ros/options/parameter_group.h"

#include <cmath>
#include <optional>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"

namespace haptic_cloth {

using XmlRpc::XmlRpcValue;

namespace {

constexpr double kUnitTolerance = 1e-3;  ///< tolerance of a quaternion's norm, as in scene files

}  // namespace

ParameterGroup::ParameterGroup(const XmlRpcValue& tree, const std::string& origin, const std::string& path)
    : tree_(tree), origin_(origin), path_(path) {
  if (tree_.getType() == XmlRpcValue::TypeInvalid || tree_.getType() == XmlRpcValue::TypeStruct) return;
  throw InputError(origin_, path_, toYaml(tree_, origin_, path_), "must be a map");
}

bool ParameterGroup::has(const std::string& key) const {
  return tree_.getType() == XmlRpcValue::TypeStruct && tree_.hasMember(key);
}

void ParameterGroup::read(const std::string& key, std::string& value) {
  known_.insert(key);
  if (!has(key)) return;
  XmlRpcValue entry = tree_[key];
  if (entry.getType() != XmlRpcValue::TypeString) fail(key, "must be text");
  value = static_cast<std::string>(entry);
}

std::size_t ParameterGroup::readChoice(const std::string& key, const std::vector<std::string>& choices,
                                       std::size_t value) {
  std::string text = choices[value], known;
  read(key, text);
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (text == choices[k]) return k;
    known += (k > 0 ? ", " : "") + choices[k];
  }
  fail(key, "must be one of " + known);
}

void ParameterGroup::read(const std::string& key, double& value, bool zero_is_good) {
  known_.insert(key);
  if (!has(key)) return;
  const std::optional<double> number = toNumber(tree_[key]);
  if (!number) fail(key, "must be a number");
  if (!std::isfinite(*number) || *number < 0.0 || (*number == 0.0 && !zero_is_good)) {
    fail(key, zero_is_good ? "must be finite and >= 0" : "must be finite and > 0");
  }
  value = *number;
}

void ParameterGroup::read(const std::string& key, bool& value) {
  known_.insert(key);
  if (!has(key)) return;
  XmlRpcValue entry = tree_[key];
  if (entry.getType() != XmlRpcValue::TypeBoolean) fail(key, "must be true or false");
  value = static_cast<bool>(entry);
}

void ParameterGroup::read(const std::string& key, Vec3& value) {
  known_.insert(key);
  if (!has(key)) return;
  const std::vector<double> entries = numbers(key, 3);
  value = Vec3(entries[0], entries[1], entries[2]);
}

void ParameterGroup::read(const std::string& key, Quat& value) {
  known_.insert(key);
  if (!has(key)) return;
  const std::vector<double> entries = numbers(key, 4);
  const Quat quaternion(entries[3], entries[0], entries[1], entries[2]);
  if (std::abs(quaternion.norm() - 1.0) > kUnitTolerance) fail(key, "must have norm 1");
  value = quaternion.normalized();
}

std::vector<double> ParameterGroup::numbers(const std::string& key, int count) const {
  const std::string rule = "must be a list of " + std::to_string(count) + " finite numbers";
  const XmlRpcValue entry = tree_[key];
  if (entry.getType() != XmlRpcValue::TypeArray || entry.size() != count) fail(key, rule);
  std::vector<double> values;
  for (int k = 0; k < count; ++k) {
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
  rest.begin();  // makes `rest` an empty map
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
