#include "ros/options/node_options.h"

#include <algorithm>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"
#include "ros/options/node_table.h"
#include "ros/options/parameter_group.h"
#include "scene/scene_options.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using XmlRpc::XmlRpcValue;

void readDevices(ParameterGroup devices, NodeOptions& options) {
  for (const ProbeOptions& probe : options.scene.probes) {
    options.probes.push_back({readDeviceOptions(devices.group(probe.name), options.device), options.haptics});
  }
  devices.rejectRest();
}

}  // namespace

NodeOptions parseNodeOptions(const XmlRpcValue& parameters, const std::string& origin) {
  NodeOptions options;
  ParameterGroup root(parameters, origin, "");
  root.read(groupsOf(options));
  const ParameterGroup devices = root.group("devices");
  options.frame_id = withoutSlash(options.frame_id);
  if (options.frame_id.empty()) throw InputError(origin, "frame_id", "''", "must not be empty");

  root.rejectRestBut(sceneKeys());
  const XmlRpcValue scene = root.rest();
  if (options.scene_file.empty()) {
    if (!scene.hasMember("cloth"))
      throw InputError(
          origin, "scene_file", "",
          "is required, unless the parameters hold a scene; a scene file that is empty gives none");
    options.scene = parseScene(toYaml(scene, origin, ""), origin, options.scene_directory);
  } else {
    options.overrides = toOverrides(scene, origin);
    options.scene = loadScene(options.scene_file, options.overrides, origin);
  }
  options.time_budget = options.scene.solver.minimizer.time_budget;
  readDevices(devices, options);
  settle(options);
  validateNodeOptions(options, origin);
  return options;
}

void settle(NodeOptions& options) {
  const double own = options.time_budget, most = options.step_budget;
  options.scene.solver.minimizer.time_budget = most > 0.0 && (own == 0.0 || own > most) ? most : own;
  for (std::size_t k = 0; k < options.probes.size(); ++k) {
    HapticOptions& haptics = options.probes[k].haptics;
    haptics = options.haptics;
    haptics.coupling_stiffness = options.scene.probes[k].coupling_stiffness;
    haptics.coupling_damping = options.scene.probes[k].coupling_damping;
  }
}

void validateNodeOptions(const NodeOptions& options, const std::string& origin) {
  const auto locate = [&origin](const std::string&) { return origin; };
  NodeOptions node = options;  // rows point to members that could be written
  for (const OptionGroup& group : groupsOf(node)) checkOptions(group.options, group.path, locate);
  const auto forbid = [&](const char* key, double budget) {
    if (node.record.empty() || !(budget > 0.0)) return;
    throw InputError(origin, key, shortestText(budget),
                     "must be 0 with record = " + node.record + ": a recording repeats no clock");
  };
  forbid("step_budget", node.step_budget);
  forbid("solver/time_budget", node.time_budget);
  node.scene.solver.minimizer.time_budget = node.time_budget;
  validateScene(node.scene, origin);
  const double longest =
      std::max(node.pace.keep_clock ? node.pace.max_time_step : 0.0, node.scene.solver.time_step);
  constexpr double kSteps = 2.0;  // that the newest snapshot may be old, with the step that follows
  if (node.haptics.snapshot_timeout < kSteps * longest)
    throw InputError(origin, "haptics/snapshot_timeout", shortestText(node.haptics.snapshot_timeout),
                     "must be at least two longest steps, " + shortestText(kSteps * longest) +
                         ": of max_time_step or solver.time_step");
  for (std::size_t k = 0; k < node.probes.size(); ++k) {
    checkOptions(optionsOf(node.probes[k].device), "devices/" + node.scene.probes[k].name + '/', locate);
    validateHapticOptions(node.probes[k].haptics, origin);
    // The session gets what the scales of the device make of them.
    validateHapticOptions(limitsAtProbe(node.probes[k].haptics, node.probes[k].device),
                          origin + ", on the probe " + node.scene.probes[k].name);
  }
}

std::vector<std::string> deviceWarnings(const NodeOptions& options) {
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < options.probes.size(); ++k) {
    const ProbeSettings& settings = options.probes[k];
    for (const std::string& warning : deviceWarnings(settings.device, settings.haptics))
      warnings.push_back(options.scene.probes[k].name + ": " + warning);
  }
  return warnings;
}

std::vector<std::string> startWarnings(const NodeOptions& options) {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> warnings = deviceWarnings(options);
  const std::size_t count = options.overrides.size(), named = std::min(count, kNamed);
  if (count == 0) return warnings;
  std::string text =
      options.scene_file + " is overridden by parameters, perhaps those of an earlier launch: ";
  for (std::size_t k = 0; k < named; ++k)
    text += (k > 0 ? ", " : "") + options.overrides[k].substr(0, options.overrides[k].find('='));
  if (count > named) text += " and " + std::to_string(count - named) + " more";
  warnings.push_back(text);
  return warnings;
}

}  // namespace haptic_cloth
