#include "ros/options/node_options.h"

#include <cmath>
#include <locale>
#include <sstream>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"
#include "ros/options/parameter_group.h"
#include "sim/scene_options.h"

namespace haptic_cloth {
namespace {

using XmlRpc::XmlRpcValue;

/// A higher rate would keep a core busy without a visible gain [Hz].
constexpr double kMostDisplayRate = 1000.0;

std::string toText(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

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
  group.read("max_torque", haptics.max_torque, true);
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

void readMarkers(ParameterGroup group, const std::string& origin, MarkerOptions& markers) {
  group.read("rate", markers.rate, false);
  group.read("force_scale", markers.force_scale, false);
  group.read("full_tension", markers.full_tension, false);
  group.read("full_bending", markers.full_bending, false);
  std::string colouring = toString(markers.colouring);
  group.read("colouring", colouring);
  markers.colouring = toMeshColouring(colouring, origin, "markers/colouring");
  group.rejectRest();
}

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
  root.read("frame_id", options.frame_id);
  root.read("scene_file", options.scene_file);
  root.read("scene_directory", options.scene_directory);
  root.read("max_pose_age", options.max_pose_age, true);
  root.read("probe_timeout", options.probe_timeout, false);
  root.read("velocity_time_constant", options.velocity_time_constant, false);
  root.read("step_budget", options.step_budget, true);
  root.read("gain_ramp", options.gain_ramp, true);
  readHaptics(root.group("haptics"), options.haptics);
  options.device = readDeviceOptions(root.group("device"));
  const ParameterGroup devices = root.group("devices");
  readMarkers(root.group("markers"), origin, options.markers);
  ParameterGroup state = root.group("state");
  state.read("rate", options.state_rate, false);
  state.rejectRest();
  if (options.frame_id.empty()) throw InputError(origin, "frame_id", "''", "must not be empty");

  root.rejectRestBut(sceneKeys());
  const XmlRpcValue scene = root.rest();
  options.scene = options.scene_file.empty()
                      ? parseScene(toYaml(scene, origin, ""), origin, options.scene_directory)
                      : loadScene(options.scene_file, toOverrides(scene, origin));
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
  const auto require = [&](bool holds, const std::string& key, double value, const char* rule) {
    if (!holds) throw InputError(origin, key, toText(value), rule);
  };
  const auto notNegative = [&](const std::string& key, double value) {
    require(std::isfinite(value) && value >= 0.0, key, value, "must be finite and >= 0");
  };
  const auto positive = [&](const std::string& key, double value) {
    require(std::isfinite(value) && value > 0.0, key, value, "must be finite and > 0");
  };
  const auto rate = [&](const std::string& key, double value) {
    positive(key, value);
    require(value <= kMostDisplayRate, key, value, "must be at most 1000");
  };
  notNegative("max_pose_age", options.max_pose_age);
  positive("probe_timeout", options.probe_timeout);
  positive("velocity_time_constant", options.velocity_time_constant);
  notNegative("step_budget", options.step_budget);
  notNegative("gain_ramp", options.gain_ramp);
  notNegative("solver/time_budget", options.time_budget);
  rate("markers/rate", options.markers.rate);
  positive("markers/force_scale", options.markers.force_scale);
  positive("markers/full_tension", options.markers.full_tension);
  positive("markers/full_bending", options.markers.full_bending);
  rate("state/rate", options.state_rate);
  validateScene(options.scene, origin);
  for (std::size_t k = 0; k < options.probes.size(); ++k) {
    const ProbeSettings& probe = options.probes[k];
    positive("devices/" + options.scene.probes[k].name + "/force_scale", probe.device.force_scale);
    validateHapticOptions(probe.haptics, origin);
  }
}

const char* toString(MeshColouring colouring) {
  switch (colouring) {
    case MeshColouring::Level:
      return "level";
    case MeshColouring::Tension:
      return "tension";
    case MeshColouring::Bending:
      return "bending";
  }
  return "unknown";
}

MeshColouring toMeshColouring(const std::string& text, const std::string& origin, const std::string& key) {
  for (const MeshColouring colouring :
       {MeshColouring::Level, MeshColouring::Tension, MeshColouring::Bending}) {
    if (text == toString(colouring)) return colouring;
  }
  throw InputError(origin, key, text, "must be level, tension or bending");
}

}  // namespace haptic_cloth
