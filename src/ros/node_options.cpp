#include "ros/node_options.h"

#include "haptic_cloth/error.h"
#include "ros/conversions.h"
#include "ros/parameter_group.h"

namespace haptic_cloth {
namespace {

using XmlRpc::XmlRpcValue;

void readAdmittance(ParameterGroup group, AdmittanceOptions& tool) {
  group.read("mass", tool.mass, false);
  group.read("damping", tool.damping, false);
  group.read("deadband", tool.deadband, true);
  group.read("force_timeout", tool.force_timeout, false);
  group.read("max_speed", tool.max_speed, false);
  group.read("max_acceleration", tool.max_acceleration, false);
  group.read("start", tool.start);
  group.read("workspace_low", tool.workspace_low);
  group.read("workspace_high", tool.workspace_high);
  group.rejectRest();
}

void readHaptics(ParameterGroup group, HapticOptions& haptics) {
  group.read("rate", haptics.rate, false);
  group.read("max_force", haptics.max_force, false);
  group.read("max_force_rate", haptics.max_force_rate, false);
  group.read("soft_start", haptics.soft_start, true);
  group.read("pose_timeout", haptics.pose_timeout, false);
  group.read("snapshot_timeout", haptics.snapshot_timeout, false);
  group.read("ramp_time", haptics.ramp_time, false);
  ParameterGroup passivity = group.group("passivity");
  passivity.read("damping", haptics.passivity.damping, true);
  passivity.read("debt", haptics.passivity.debt, true);
  passivity.read("device_damping", haptics.passivity.device_damping, true);
  passivity.read("store", haptics.passivity.store, true);
  passivity.read("loop_delay", haptics.passivity.loop_delay, true);
  passivity.rejectRest();
  readAdmittance(group.group("admittance"), haptics.admittance);
  group.rejectRest();
}

/// Every probe's device and limits.
void settleProbes(ParameterGroup devices, const std::string& origin, NodeOptions& options) {
  for (const ProbeOptions& probe : options.scene.probes) {
    ProbeSettings settings{readDeviceOptions(devices.group(probe.name), options.device), options.haptics};
    settings.haptics.coupling_stiffness = probe.coupling_stiffness;
    settings.haptics.coupling_damping = probe.coupling_damping;
    validateHapticOptions(settings.haptics, origin);
    options.probes.push_back(settings);
  }
  devices.rejectRest();
}

}  // namespace

NodeOptions parseNodeOptions(const XmlRpcValue& parameters, const std::string& origin) {
  NodeOptions options;
  ParameterGroup root(parameters, origin, "");
  root.read("frame_id", options.frame_id);
  root.read("scene_file", options.scene_file);
  root.read("max_pose_age", options.max_pose_age, true);
  root.read("probe_timeout", options.probe_timeout, false);
  root.read("velocity_time_constant", options.velocity_time_constant, false);
  root.read("step_budget", options.step_budget, true);
  readHaptics(root.group("haptics"), options.haptics);
  options.device = readDeviceOptions(root.group("device"));
  const ParameterGroup devices = root.group("devices");
  ParameterGroup markers = root.group("markers");
  markers.read("rate", options.markers_rate, false);
  markers.read("force_scale", options.markers_force_scale, false);
  markers.rejectRest();
  ParameterGroup state = root.group("state");
  state.read("rate", options.state_rate, false);
  state.rejectRest();
  if (options.frame_id.empty()) throw InputError(origin, "frame_id", "''", "must not be empty");

  const XmlRpcValue scene = root.rest();
  options.scene = options.scene_file.empty() ? parseScene(toYaml(scene, origin, ""), origin, ".")
                                             : loadScene(options.scene_file, toOverrides(scene, origin));
  double& budget = options.scene.solver.minimizer.time_budget;
  if (options.step_budget > 0.0 && (budget == 0.0 || budget > options.step_budget))
    budget = options.step_budget;
  settleProbes(devices, origin, options);
  return options;
}

}  // namespace haptic_cloth
