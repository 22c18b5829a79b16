#include "ros/input/device_map.h"

#include <cstdio>

namespace haptic_cloth {
namespace {

/// With scales beyond these a limit of the force could not be computed to rounding.
constexpr Range kScale{1e-6, 1e5};

constexpr double kStrongest = 250.0;  ///< of a HapticMaster, the strongest device known to us [N]

std::string tooHigh(const char* what, const char* unit, double felt, double limit, const char* parameter,
                    double value) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "the hand would feel a %s of %.4g %s (%s x position_scale x force_scale), more than the device "
      "renders (%.4g %s): it may buzz. Set the probe's %s to %.4g or less",
      what, felt, unit, parameter, limit, unit, parameter, value);
  return text;
}

}  // namespace

Options optionsOf(DeviceOptions& device) {
  return {
      {"kind", field(device.kind, deviceKindNames()), kNoRange, "", "pose in and force out, or the reverse"},
      {"position_unit", field(device.position_unit), kScale, "m",
       "one unit of the driver's positions; 0.001 for millimetres"},
      {"position_scale", field(device.position_scale), kScale, "",
       "motion of the probe per motion of the hand"},
      {"force_scale", field(device.force_scale), kScale, "", "force on the hand per force on the probe",
       Live{0.01, 10.0}},
      {"offset", field(device.offset), kPosition, "m", "position of the driver's origin"},
      {"orientation", field(device.orientation), kNoRange, "", "of the driver's axes"},
      {"force_axes", field(device.force_axes), kNoRange, "",
       "of the force's axes, seen from those of the positions"},
      {"use_tf", field(device.use_tf), kNoRange, "",
       "tf transforms the frame of the poses; else it is `frame_id`"},
      {"max_stiffness", field(device.max_stiffness), kNotNegative, "N/m",
       "largest that the device renders; 0: unknown"},
      {"max_damping", field(device.max_damping), kNotNegative, "N·s/m",
       "largest that the device renders; 0: unknown"},
      {"workspace_radius", field(device.workspace_radius), kNotNegative, "m",
       "warns if poses cannot be in metres; 0: unknown"}};
}

DeviceOptions readDeviceOptions(ParameterGroup group, DeviceOptions device) {
  group.read(optionsOf(device));
  group.rejectRest();
  return device;
}

Vec3 placed(const DeviceOptions& device, const Vec3& position) {
  return device.offset + device.orientation * (device.position_scale * device.position_unit * position);
}

Quat placed(const DeviceOptions& device, const Quat& orientation) { return device.orientation * orientation; }

Pose poseForDriver(const DeviceOptions& device, const Pose& pose) {
  const Quat into = device.orientation.conjugate();
  return {into * (pose.position - device.offset) / (device.position_scale * device.position_unit),
          into * pose.orientation};
}

Vec3 forceForDriver(const DeviceOptions& device, const Quat& frame, const Vec3& force) {
  return device.force_scale * ((frame * device.orientation * device.force_axes).conjugate() * force);
}

Wrench wrenchForDriver(const DeviceOptions& device, const Quat& frame, const Wrench& wrench) {
  return {forceForDriver(device, frame, wrench.force),
          forceForDriver(device, frame, wrench.torque) / device.position_scale};
}

Wrench wrenchOnHand(const DeviceOptions& device, const Wrench& wrench) {
  return {device.force_scale * wrench.force, device.force_scale / device.position_scale * wrench.torque};
}

Vec3 forceAtProbe(const DeviceOptions& device, const Quat& frame, const Vec3& force) {
  return (frame * device.orientation * device.force_axes) * force / device.force_scale;
}

HapticOptions limitsAtProbe(HapticOptions haptics, const DeviceOptions& device) {
  haptics.max_force /= device.force_scale;
  haptics.max_force_rate /= device.force_scale;
  haptics.max_torque *= device.position_scale / device.force_scale;
  PassivityOptions& passivity = haptics.passivity;
  passivity.damping /= device.force_scale * device.position_scale;
  passivity.device_damping /= device.force_scale * device.position_scale;
  passivity.debt *= device.position_scale / device.force_scale;
  passivity.store *= device.position_scale / device.force_scale;
  AdmittanceOptions& tool = haptics.admittance;
  tool.mass /= device.force_scale * device.position_scale;
  tool.damping /= device.force_scale * device.position_scale;
  tool.deadband /= device.force_scale;
  tool.max_speed *= device.position_scale;
  tool.max_acceleration *= device.position_scale;
  return haptics;
}

double feltStiffness(const DeviceOptions& device, const HapticOptions& haptics) {
  return haptics.coupling_stiffness * device.position_scale * device.force_scale;
}

double feltDamping(const DeviceOptions& device, const HapticOptions& haptics) {
  return haptics.coupling_damping * device.position_scale * device.force_scale;
}

std::vector<std::string> deviceWarnings(const DeviceOptions& device, const HapticOptions& haptics) {
  std::vector<std::string> warnings;
  if (haptics.max_force > kStrongest) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "haptics/max_force = %.4g N is more than any haptic device exerts (%.4g N)",
                  haptics.max_force, kStrongest);
    warnings.emplace_back(text);
  }
  if (device.kind == DeviceKind::Admittance) return warnings;
  const double scale = device.position_scale * device.force_scale;
  const double stiffness = feltStiffness(device, haptics), damping = feltDamping(device, haptics);
  if (device.max_stiffness > 0.0 && stiffness > device.max_stiffness) {
    warnings.push_back(tooHigh("stiffness", "N/m", stiffness, device.max_stiffness, "coupling_stiffness",
                               device.max_stiffness / scale));
  }
  if (device.max_damping > 0.0 && damping > device.max_damping) {
    warnings.push_back(tooHigh("damping", "N s/m", damping, device.max_damping, "coupling_damping",
                               device.max_damping / scale));
  }
  return warnings;
}

}  // namespace haptic_cloth
