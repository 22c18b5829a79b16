#include "ros/options/reconfigure_messages.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

using dynamic_reconfigure::Config;

constexpr char kRoot[] = "Default";  ///< name that the tools expect for the root group

/// Group of an option: "haptics" for "haptics/rate".
std::string groupOf(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? kRoot : name.substr(0, slash);
}

/// Appends the value to the list of its type.
void add(Config& config, const std::string& name, const LiveValue& value) {
  const auto append = [&name](auto& list, const auto& v) {
    list.emplace_back();
    list.back().name = name;
    list.back().value = v;
  };
  if (const bool* flag = std::get_if<bool>(&value)) append(config.bools, *flag);
  if (const int* whole = std::get_if<int>(&value)) append(config.ints, *whole);
  if (const double* number = std::get_if<double>(&value)) append(config.doubles, *number);
  if (const std::string* text = std::get_if<std::string>(&value)) append(config.strs, *text);
}

const char* typeOf(const LiveValue& value) {
  return std::holds_alternative<bool>(value)     ? "bool"
         : std::holds_alternative<int>(value)    ? "int"
         : std::holds_alternative<double>(value) ? "double"
                                                 : "str";
}

/// Choices in the syntax that the tools parse as Python; empty if there are none.
std::string editMethod(const LiveOption& option) {
  std::string words;
  for (const std::string& word : option.choices) {
    words += (words.empty() ? "" : ", ") + ("{'name': '" + word) + "', 'type': 'str', 'value': '" + word +
             "', 'srcline': 0, 'srcfile': '', 'description': '" + word +
             "', 'ctype': 'std::string', 'cconsttype': 'const char * const'}";
  }
  return words.empty() ? "" : "{'enum': [" + words + "], 'enum_description': ''}";
}

/// Names of the groups in order; the root group is first.
std::vector<std::string> groupNames(const std::vector<LiveOption>& offered) {
  std::vector<std::string> names{kRoot};
  for (const LiveOption& option : offered) {
    const std::string name = groupOf(option.name);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

LiveValues toValues(const Config& config) {
  LiveValues values;
  for (const auto& entry : config.ints) values[entry.name] = entry.value;
  for (const auto& entry : config.doubles) values[entry.name] = entry.value;
  for (const auto& entry : config.strs) values[entry.name] = entry.value;
  for (const auto& entry : config.bools) values[entry.name] = entry.value != 0;
  return values;
}

Config toConfig(const std::vector<LiveOption>& offered, const NodeOptions& options) {
  Config config;
  const LiveValues values = liveValues(options);
  for (const LiveOption& option : offered) add(config, option.name, values.at(option.name));
  const std::vector<std::string> names = groupNames(offered);
  for (std::size_t id = 0; id < names.size(); ++id) {
    config.groups.emplace_back();
    config.groups.back().name = names[id];
    config.groups.back().state = true;
    config.groups.back().id = static_cast<int>(id);
  }
  return config;
}

dynamic_reconfigure::ConfigDescription toDescription(const std::vector<LiveOption>& offered,
                                                     const NodeOptions& options) {
  dynamic_reconfigure::ConfigDescription description;
  description.dflt = toConfig(offered, options);
  description.min.groups = description.max.groups = description.dflt.groups;
  const std::vector<std::string> names = groupNames(offered);
  for (std::size_t id = 0; id < names.size(); ++id) {
    dynamic_reconfigure::Group group;
    group.name = names[id];
    group.id = static_cast<int>(id);
    for (const LiveOption& option : offered) {
      if (groupOf(option.name) != names[id]) continue;
      group.parameters.emplace_back();
      group.parameters.back().name = option.name;
      group.parameters.back().type = typeOf(option.low);
      group.parameters.back().description = option.description;
      group.parameters.back().edit_method = editMethod(option);
    }
    description.groups.push_back(group);
  }
  for (const LiveOption& option : offered) {
    add(description.min, option.name, option.low);
    add(description.max, option.name, option.high);
  }
  return description;
}

}  // namespace haptic_cloth
