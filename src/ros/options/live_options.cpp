#include "ros/options/live_options.h"

#include <algorithm>
#include <utility>

#include "haptic_cloth/error.h"
#include "ros/options/node_table.h"
#include "scene/scene_options.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using LiveRows = std::vector<std::pair<std::string, Option>>;  ///< with their full names

void append(LiveRows& rows, const std::string& path, const Options& options) {
  for (const Option& option : options) rows.emplace_back(path + option.key, option);
}

/// Rows of all options that can be told by one name, live or not.
LiveRows allRows(NodeOptions& node) {
  LiveRows rows;
  for (const OptionGroup& group : groupsOf(node)) {
    append(rows, group.path, group.options);
  }
  append(rows, "", worldOptions(node.scene));
  for (std::size_t k = 0; k < node.probes.size(); ++k) {
    ProbeOptions& probe = node.scene.probes[k];
    append(rows, probeKey(node.scene, probe, '/') + '/', optionsOf(probe));
    append(rows, "devices/" + probe.name + '/', optionsOf(node.probes[k].device));
  }
  append(rows, "solver/", optionsOf(node.scene.solver));
  append(rows, "adapt/", optionsOf(node.scene.adapt));
  append(rows, "cloth/", optionsOf(node.scene.cloth));
  append(rows, "stop/", optionsOf(node.scene.stop));
  for (auto& [name, option] : rows) {  // the scene holds the smaller of two budgets
    if (name == "solver/time_budget") option.field = field(node.time_budget);
  }
  return rows;
}

/// Rows of all live options. Those of `device` are only defaults for the probes at start.
LiveRows liveRows(NodeOptions& node) {
  LiveRows rows = allRows(node);
  const auto is_fixed = [](const LiveRows::value_type& row) {
    return !row.second.live || row.first.rfind(kDevicePath, 0) == 0;
  };
  rows.erase(std::remove_if(rows.begin(), rows.end(), is_fixed), rows.end());
  return rows;
}

LiveValue valueOf(const Option& option) {
  if (const auto* flag = std::get_if<bool*>(&option.field)) return **flag;
  if (const auto* whole = std::get_if<Numbers<int>>(&option.field)) return *whole->first;
  if (const auto* number = std::get_if<Numbers<double>>(&option.field)) return *number->first;
  return valueText(option);
}

/// Value of the same type as the option's.
LiveValue sliderEnd(const Option& option, double end) {
  const LiveValue value = valueOf(option);
  if (std::holds_alternative<bool>(value)) return end > 0.0;
  if (std::holds_alternative<int>(value)) return static_cast<int>(end);
  if (std::holds_alternative<double>(value)) return end;
  return std::string();
}

std::vector<std::string> choicesOf(const Option& option) {
  const auto* choice = std::get_if<Choice>(&option.field);
  return choice != nullptr ? choice->names : std::vector<std::string>();
}

/// Assigns a value to its option. @return the rule it breaks; empty if it is valid
std::string assign(const Option& option, const LiveValue& value) {
  if (const auto* flag = std::get_if<bool*>(&option.field)) {
    if (!std::holds_alternative<bool>(value)) return "must be true or false";
    **flag = std::get<bool>(value);
  } else if (const auto* whole = std::get_if<Numbers<int>>(&option.field)) {
    if (!std::holds_alternative<int>(value)) return "must be a whole number";
    *whole->first = std::get<int>(value);
  } else if (const auto* number = std::get_if<Numbers<double>>(&option.field)) {
    if (!std::holds_alternative<int>(value) && !std::holds_alternative<double>(value)) {
      return "must be a number";
    }
    const int* const whole_value = std::get_if<int>(&value);
    *number->first = whole_value != nullptr ? *whole_value : std::get<double>(value);
  } else if (const auto* choice = std::get_if<Choice>(&option.field)) {
    if (!std::holds_alternative<std::string>(value)) return "must be text";
    const std::vector<std::string>& names = choice->names;
    const auto found = std::find(names.begin(), names.end(), std::get<std::string>(value));
    if (found == names.end()) return oneOf(names);
    choice->set(static_cast<std::size_t>(found - names.begin()));
  }
  return "";
}

std::string toText(const LiveValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const int* whole = std::get_if<int>(&value)) return std::to_string(*whole);
  if (const double* number = std::get_if<double>(&value)) return shortestText(*number);
  return std::get<std::string>(value);
}

Gains gainsOf(const NodeOptions& options, std::size_t k) {
  const ProbeOptions& probe = options.scene.probes[k];
  return {probe.coupling_stiffness, probe.coupling_damping, options.probes[k].device.force_scale};
}

}  // namespace

std::vector<LiveOption> offeredOptions(const NodeOptions& options) {
  NodeOptions node = options;  // rows point to members that could be written
  std::vector<LiveOption> offered;
  for (const auto& [name, option] : liveRows(node)) {
    offered.push_back({name, describe(option), sliderEnd(option, option.live->low),
                       sliderEnd(option, option.live->high), choicesOf(option)});
  }
  return offered;
}

LiveValues liveValues(const NodeOptions& options) {
  NodeOptions node = options;
  LiveValues values;
  for (const auto& [name, option] : liveRows(node)) values[name] = valueOf(option);
  return values;
}

NodeOptions changed(const NodeOptions& options, const LiveValues& values, const std::string& origin) {
  NodeOptions next = options;
  LiveValues left = values;
  for (const auto& [name, option] : liveRows(next)) {
    const auto entry = left.find(name);
    if (entry == left.end()) continue;
    const std::string broken = assign(option, entry->second);
    if (!broken.empty()) throw InputError(origin, name, toText(entry->second), broken);
    left.erase(entry);
  }
  if (!left.empty()) {
    const std::string& name = left.begin()->first;
    const LiveRows all = allRows(next);
    const bool known =
        std::any_of(all.begin(), all.end(), [&](const auto& row) { return row.first == name; });
    throw InputError(origin, name, toText(left.begin()->second),
                     known ? "cannot change while the node runs" : "unknown parameter");
  }
  settle(next);
  validateNodeOptions(next, origin);
  return next;
}

LiveOptions firstOptions(const NodeOptions& options) {
  LiveOptions first;
  first.options = std::make_shared<const NodeOptions>(options);
  for (std::size_t k = 0; k < options.probes.size(); ++k) first.gains.emplace_back(gainsOf(options, k));
  return first;
}

LiveOptions nextOptions(const LiveOptions& last, const NodeOptions& options, double now) {
  LiveOptions next = last;
  ++next.number;
  next.options = std::make_shared<const NodeOptions>(options);
  for (std::size_t k = 0; k < next.gains.size(); ++k) {
    const Gains gains = gainsOf(options, k);
    // A change of another option must not restart the ramps of gains that did not change.
    if (gains != gainsOf(*last.options, k)) next.gains[k] = last.gains[k].onTo(gains, now, options.gain_ramp);
  }
  return next;
}

}  // namespace haptic_cloth
